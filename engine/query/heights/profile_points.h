// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of a profile, from what triangles hold of its lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/heights/ground_stretches.h"
#include "engine/query/heights/profile.h"
#include "engine/query/shape/spot.h"
#include "storage/store_facts.h"

namespace ptin {

/// The spots of a line, and the distance at which each stands.
struct SpotLine {
  std::uint32_t number = 0;
  std::vector<Spot> spots;
  std::vector<MapPoint> positions;
  std::vector<double> distances;
};

/// A line as spots, repetitions left out; fewer than two spots when the line has no length.
/// @param number, count  Which line of how many, for errors.
/// @throws Error invalid_argument  a coordinate that is not finite, or too far from the terrain
[[nodiscard]] SpotLine spot_line(std::span<const MapPoint> line, std::size_t number,
                                 std::size_t count, const StoreFacts& facts,
                                 const ProfileRequest& request);

/// A share of the way of a segment with ground at it.
struct GroundPoint {
  double share, code;
  friend bool operator<(const GroundPoint& a, const GroundPoint& b) noexcept {
    return a.share != b.share ? a.share < b.share : a.code < b.code;
  }
};

/// Appends the points of one segment. Where a point of the same line and distance is there already,
/// it is brought up to date instead.
class SegmentWriter {
 public:
  /// All borrowed for the life of the writer.
  SegmentWriter(const StoreFacts& facts, const SpotLine& line, std::vector<ProfilePoint>& points)
      : facts_(facts), line_(line), points_(points) {}

  /// @param stretches  What triangles hold of the segment, as GroundStretches::of() has them.
  void write(std::uint32_t part, std::span<const GroundStretch> stretches);

 private:
  void find_ground(std::span<const GroundStretch> stretches);
  [[nodiscard]] std::optional<double> ground_at(double share) const;
  void put(double share, std::optional<double> ground, PointState state);

  const StoreFacts& facts_;
  const SpotLine& line_;
  std::vector<ProfilePoint>& points_;
  std::vector<GroundPoint> ground_;  ///< Ground along the segment at hand.
  std::uint32_t part_ = 0;
};

}  // namespace ptin
