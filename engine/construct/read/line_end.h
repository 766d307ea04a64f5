// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ends of lines of text: LF, CR LF, or a CR alone, in one text too.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace ptin {

/// The LF or CR that ends the line which begins at `begin`; null where there is none before `end`.
/// Cost: that of two calls of memchr() over the line.
[[nodiscard]] inline const char* end_of_line(const char* begin, const char* end) noexcept {
  // A text without one of both would be looked through to its end for each of its lines.
  constexpr std::ptrdiff_t kWindow = 256;
  while (begin < end) {
    const auto width = static_cast<std::size_t>(std::min(kWindow, end - begin));
    const auto* lf = static_cast<const char*>(std::memchr(begin, '\n', width));
    const std::size_t before = lf == nullptr ? width : static_cast<std::size_t>(lf - begin);
    const auto* cr = static_cast<const char*>(std::memchr(begin, '\r', before));
    if (cr != nullptr || lf != nullptr) {
      return cr != nullptr ? cr : lf;
    }
    begin += width;
  }
  return nullptr;
}

/// How many bytes the line end at `at` has: two where it is CR LF.
[[nodiscard]] inline std::size_t bytes_of_line_end(const char* at, const char* end) noexcept {
  return *at == '\r' && at + 1 < end && at[1] == '\n' ? 2 : 1;
}

}  // namespace ptin
