// SPDX-License-Identifier: GPL-3.0-or-later
//
// The convex hull of a stream of points, and which edges lie on it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/geometry/point.h"

namespace ptin {

/// A convex hull: its strict corners, counter-clockwise, from the lowest (then leftmost) one.
/// Points on one line have a hull of two corners, a single point one of one.
class ConvexHull {
 public:
  ConvexHull() = default;
  /// @param corners  The strict corners, in the order in which corners() returns them.
  explicit ConvexHull(std::vector<GridPoint> corners) : corners_(std::move(corners)) {}

  [[nodiscard]] const std::vector<GridPoint>& corners() const noexcept { return corners_; }
  /// True when the edge from `a` to `b`, both in the hull, lies on one of its sides, with the hull
  /// on its left. Cost: logarithmic.
  [[nodiscard]] bool has_on_border(GridPoint a, GridPoint b) const noexcept;

 private:
  std::vector<GridPoint> corners_;
};

/// Collects the convex hull of points that come one by one. Memory: 4096 points, or twice the
/// corners of the hull where that is more. Cost of add(): eight orientations for most points, since
/// they lie in the octagon of the extreme points before them and are dropped.
class HullCollector {
 public:
  void add(GridPoint p) {
    if (!octagon_holds(p)) {
      points_.push_back(p);
      if (points_.size() >= limit_) {
        shrink();
      }
    }
  }
  [[nodiscard]] ConvexHull hull();

 private:
  [[nodiscard]] bool octagon_holds(GridPoint p) const noexcept;
  void shrink();

  std::vector<GridPoint> points_;
  /// The hull of extreme points seen so far, counter-clockwise; empty at first.
  std::vector<GridPoint> octagon_;
  std::size_t limit_ = 4096;
};

}  // namespace ptin
