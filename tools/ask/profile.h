// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of heights along lines: `ptin profile`, and over HTTP `profile` and `trajectory`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/crs/ground.h"
#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

void add_profile(Parameters& rows, ProfileRequest& request);
/// Has distances run over ground where map units are degrees, which are no lengths: in metres.
void set_ground(ProfileRequest& request, const Ground& ground);
/// The unit of distances along lines.
[[nodiscard]] std::string length_unit_of(const CrsFacts& crs);

/// A point of a profile as it is told.
struct ProfileRow {
  const ProfilePoint& point;
  MapPoint at;                      ///< In the CRS of whoever asked.
  double deviation = 0.0;           ///< Certified.
  bool has_stations = true;         ///< Some points are stations.
  const std::string* id = nullptr;  ///< Of its line; null: the input has none.
};
[[nodiscard]] Fields<ProfileRow> profile_fields();

/// A line of a profile as it is told.
struct ProfileLineRow {
  std::span<const ProfilePoint> points;
  const ProfileResult& profile;
  const std::string* id = nullptr;
};
[[nodiscard]] Fields<ProfileLineRow> profile_line_fields();
/// The stretches of one line that have heights: calls `take` with the first and the last place of each.
template <typename Take>
void for_each_stretch(std::span<const ProfilePoint> points, const Take& take) {
  for (std::size_t i = 0; i < points.size();) {
    std::size_t last = i;
    while (last + 1 < points.size() && points[last].state == PointState::kSurface &&
           points[last + 1].height == points[last + 1].height) {
      ++last;
    }
    // A height that is none is not equal to itself.
    if (last > i && points[i].height == points[i].height) take(i, last);
    i = last + 1;
  }
}

/// A profile as a whole.
struct ProfileAnswer {
  const ProfileResult& profile;
  const CrsFacts& crs;
  const std::vector<std::string>* ids = nullptr;  ///< Of the lines; null: the input has none.
  double bent_at_most =
      0.0;  ///< How far a side of the client's CRS is from the line walked, map units.
};
[[nodiscard]] Fields<ProfileAnswer> profile_answer_fields();

}  // namespace ptin::ask
