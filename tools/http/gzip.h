// SPDX-License-Identifier: GPL-3.0-or-later
//
// Answers in fewer bytes, for clients that take them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ptin::http {

/// Whether a header Accept-Encoding takes gzip: named, or by a star, with a weight above 0.
[[nodiscard]] bool takes_gzip(std::string_view accept_encoding);

/// How often a packed text is sent.
enum class GzipFor : std::uint8_t { kOneAnswer, kManyAnswers };

/// The text as a gzip member without a name or a time, so that equal texts give equal bytes.
/// @throws Error resource_exhausted  zlib is refused memory
/// Cost: linear; about 100 MB/s, a fifth of that for many answers, which a hundredth fewer bytes are worth.
[[nodiscard]] std::string gzip(std::string_view text, GzipFor use = GzipFor::kOneAnswer);

}  // namespace ptin::http
