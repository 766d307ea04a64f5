// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers as text that reads back to the same bits.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>

namespace ptin::tools {

/// Appends the shortest decimal that reads back to exactly `value`; plain digits as long as they
/// are not longer than an exponent would be. REQUIRES: finite.
inline void append_number(std::string& text, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

inline void append_number(std::string& text, std::uint64_t value) {
  char digits[24];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

}  // namespace ptin::tools
