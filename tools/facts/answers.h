// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words of answers, the same in text and JSON.
#pragma once

#include <span>
#include <vector>

#include "engine/query/questions.h"

namespace ptin::tools {

[[nodiscard]] constexpr const char* name_of(PointState s) noexcept {
  return s == PointState::kSurface ? "surface" : (s == PointState::kVoid ? "void" : "outside");
}

[[nodiscard]] constexpr const char* name_of(SightVerdict v) noexcept {
  switch (v) {
    case SightVerdict::kVisible:
      return "visible";
    case SightVerdict::kHidden:
      return "hidden";
    case SightVerdict::kUndecided:
      return "undecided";
    case SightVerdict::kUndefined:
      break;
  }
  return "undefined";
}

/// The points of each line of a profile that has any.
[[nodiscard]] inline std::vector<std::span<const ProfilePoint>> lines_of(
    const ProfileResult& profile) {
  std::vector<std::span<const ProfilePoint>> lines;
  const std::span<const ProfilePoint> all(profile.points);
  for (std::size_t begin = 0, i = 1; i <= all.size(); ++i) {
    if (i < all.size() && all[i].line == all[begin].line) continue;
    lines.push_back(all.subspan(begin, i - begin));
    begin = i;
  }
  return lines;
}

}  // namespace ptin::tools
