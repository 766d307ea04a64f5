// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/depth_names.h"

#include <algorithm>
#include <array>
#include <string>

namespace ptin {

namespace {

constexpr std::array<std::string_view, 10> kWords = {"depth",     "depths", "deptho", "sounding",
                                                     "soundings", "soundg", "valsou", "drval1",
                                                     "drval2",    "valdco"};

bool is_letter_or_digit(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

}  // namespace

bool is_name_of_depths(std::string_view name) {
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  for (auto at = small.cbegin(); at != small.cend();) {
    const auto begin = std::find_if(at, small.cend(), is_letter_or_digit);
    const auto end = std::find_if_not(begin, small.cend(), is_letter_or_digit);
    if (std::find(kWords.begin(), kWords.end(), std::string_view(begin, end)) != kWords.end()) {
      return true;
    }
    at = end;
  }
  return false;
}

}  // namespace ptin
