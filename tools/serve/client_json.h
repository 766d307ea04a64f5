// SPDX-License-Identifier: GPL-3.0-or-later
//
// JSON that a client sent: read once, in a time and a memory that its length bounds.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace ptin::serve {

/// Bounds on the JSON of a client.
struct JsonBounds {
  int most_deep = 16;  ///< Objects and arrays within each other.
  /// Bytes of the parsed form, which takes up to kBytesOfValue a value beside the text itself.
  std::uint64_t memory_bytes = std::uint64_t{16} << 20;
  std::stop_token stop;  ///< Looked at every few thousand values.
};

/// A value of the parsed form takes so much at most: an empty object as the member of an object,
/// its name, and what a growing array takes twice.
inline constexpr std::uint64_t kBytesOfValue = 128;

/// @param name  The parameter that a refusal names.
/// @throws http::Problem 400  no JSON, or deeper; an object with two members of one name
///                       413  more values than the memory holds
///         Error cancelled
/// Cost: linear in the text, beside a logarithm of the members of an object.
[[nodiscard]] nlohmann::json json_of_client(std::string_view text, std::string_view name,
                                            const JsonBounds& bounds = {});

}  // namespace ptin::serve
