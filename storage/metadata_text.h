// SPDX-License-Identifier: GPL-3.0-or-later
//
// How deep the metadata of a file or a stream are nested, found before anything parses them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace ptin {

/// The deepest nesting of metadata that readers accept; metadata that `ptin` writes have four
/// levels. JSON parsers copy and print by recursion, so that text from an unknown source could use
/// up the stack.
inline constexpr std::size_t kMostNesting = 64;

/// How deep brackets and braces of a JSON text are nested, not counting those in strings. A text
/// that is not JSON gives a number too. Cost: linear.
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
