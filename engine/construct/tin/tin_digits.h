// SPDX-License-Identifier: GPL-3.0-or-later
//
// Digits of coordinates that the grid cannot keep: programs write TINs with all digits of a double.
#pragma once

#include <array>
#include <cmath>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// Sees all vertices once, then knows how many digits behind the point the grid keeps.
class TinDigits {
 public:
  void add(const SourcePoint& p) noexcept;
  /// Of those that x and y have, as many as leave no more than 2^30 steps across.
  [[nodiscard]] int kept() const noexcept;

 private:
  struct Axis {
    double low = INFINITY, high = -INFINITY;
  };
  std::array<Axis, 2> axes_;
  int decimals_ = 0;
};

/// How far a vertex moved, CRS units: before less after.
struct DroppedDigits {
  double x = 0.0, y = 0.0;
};

/// Rounds x and y to so many digits behind the point, half away from zero.
DroppedDigits drop_digits(SourcePoint& p, int decimals) noexcept;

}  // namespace ptin
