// SPDX-License-Identifier: GPL-3.0-or-later
//
// Strong validators: the same tag, the same bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ptin::http {

/// 16 hexadecimal digits.
[[nodiscard]] std::string hex_of(std::uint64_t number);

/// The tag of what `text` stands for, in quotes: 128 bits of XXH3.
[[nodiscard]] std::string etag_of(std::string_view text);

/// The tag of the same answer under gzip, which has other bytes.
[[nodiscard]] std::string gzip_etag_of(const std::string& etag);

/// Whether a list of tags, as of If-None-Match, names the tag or its other form under gzip.
/// @param weak_too  A weak tag (W/) names them as well.
[[nodiscard]] bool names_etag(std::string_view list, const std::string& etag, bool weak_too = true);

}  // namespace ptin::http
