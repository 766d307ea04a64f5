// SPDX-License-Identifier: GPL-3.0-or-later
//
// The encoding of a text, as its first bytes show: UTF-8 and what contains ASCII are read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace ptin {

/// The length of the byte order mark of UTF-8 at the begin of a text; 0 where it has none.
[[nodiscard]] std::size_t bytes_of_byte_order_mark(std::string_view text) noexcept;

/// Why a line is not read as text, with a way out: the text is UTF-16 or UTF-32, by its byte order
/// mark or by bytes of value 0 among its characters. None where it can be read.
/// @param is_first  The line is the first one of its text.
[[nodiscard]] std::optional<std::string> fault_of_encoding(std::string_view line, bool is_first);

}  // namespace ptin
