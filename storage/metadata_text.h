// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the metadata of a file or a stream may be, before anything parses it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace ptin {

/// Deepest nesting of metadata; ours has four. Parsers copy and print by recursion, and a file may
/// come from anybody.
inline constexpr std::size_t kMostNesting = 64;

/// How deep brackets and braces of a JSON text are nested, those in strings left out. Of a text
/// that is no JSON a number all the same. Cost: linear.
[[nodiscard]] inline std::size_t nesting_of(std::string_view json) noexcept {
  std::size_t depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      i += c == '\\' ? 1 : 0;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

}  // namespace ptin
