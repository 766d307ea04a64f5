// SPDX-License-Identifier: GPL-3.0-or-later
//
// Digits of coordinates that the grid cannot keep: programs write TINs with all digits of a double.
#pragma once

#include <array>
#include <cmath>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// Sees all vertices once, then tells how many digits after the point the grid keeps.
class TinDigits {
 public:
  void add(const SourcePoint& p) noexcept;
  /// All digits after the point that some x or y has; fewer where the vertices would otherwise span
  /// more than 2^30 steps, or lie farther than kMostStepsFromZero steps from 0.
  [[nodiscard]] int kept() const noexcept;

 private:
  struct Axis {
    double low = INFINITY, high = -INFINITY;
  };
  std::array<Axis, 2> axes_;
  int decimals_ = 0;
};

/// How dropping digits moved a vertex: coordinates before less those after, CRS units.
struct DroppedDigits {
  double x = 0.0, y = 0.0;
};

/// Rounds the x and y of `p` to at most `decimals` digits after the point, half away from zero.
DroppedDigits drop_digits(SourcePoint& p, int decimals) noexcept;

}  // namespace ptin
