// SPDX-License-Identifier: GPL-3.0-or-later
//
// Letters of any case, as names of headers, codings and hosts have them.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace ptin::http {

/// The text with small letters; ptin sets no locale, so these are those of ASCII.
[[nodiscard]] inline std::string lower_letters(std::string_view text) {
  std::string low(text);
  for (char& c : low) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return low;
}

}  // namespace ptin::http
