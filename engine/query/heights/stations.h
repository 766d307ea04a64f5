// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stations: points at equal distances along the lines of a profile, beside its breaks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/heights/profile.h"

namespace ptin {

/// Counts the stations of lines before anything is read, so that a step far too small is refused.
class StationCount {
 public:
  /// @param step  ProfileRequest::station_step; 0: there are no stations.
  /// @throws Error invalid_argument  negative, or not finite
  explicit StationCount(double step);

  /// Counts those of a line of this length.
  void add(double length) noexcept;
  /// The memory of points for all of them.
  /// @throws Error resource_exhausted  more than `memory_bytes`; names the number of stations
  [[nodiscard]] std::uint64_t bytes_within(std::uint64_t memory_bytes) const;

 private:
  double step_;
  double count_ = 0.0;  ///< May be more than any integer holds.
};

/// The points of a profile, and among them the stations that StationCount counts. A surface is
/// straight between two breaks, so what is weighed by distance there is its height. A break nearer
/// to a station than a thousand-millionth of its line's length is that station, and stays as it is.
/// Cost: the points that are made, and their memory beside `breaks`.
/// @param breaks  Line by line, as ProfileResult::points.
/// @param step    > 0.
[[nodiscard]] std::vector<ProfilePoint> with_stations(std::span<const ProfilePoint> breaks,
                                                      double step);

}  // namespace ptin
