// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances on the ground between points that need not be vertices.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/construct/grid/crs.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A point that need not be a vertex, in grid units.
struct GroundPlace {
  double x, y;
};

inline GroundPlace place_of(GridPoint p) noexcept {
  return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

inline double distance(GroundPlace a, GroundPlace b, GroundStep step) noexcept {
  const double x = (a.x - b.x) * step.x, y = (a.y - b.y) * step.y;
  return std::sqrt(x * x + y * y);
}

inline double distance(GridPoint a, GridPoint b, GroundStep step) noexcept {
  return distance(place_of(a), place_of(b), step);
}

/// At least the distance on the ground from p to the straight edge a-b.
inline double distance_bound(GroundPlace p, GroundPlace a, GroundPlace b,
                             GroundStep step) noexcept {
  const double ux = (b.x - a.x) * step.x, uy = (b.y - a.y) * step.y;
  const double vx = (p.x - a.x) * step.x, vy = (p.y - a.y) * step.y;
  const double length = ux * ux + uy * uy;
  const double t = length > 0.0 ? std::clamp((ux * vx + uy * vy) / length, 0.0, 1.0) : 0.0;
  const double x = vx - t * ux, y = vy - t * uy;
  // The differences x and y cancel where p is near the edge, so their error is a share of the lengths u and v, not of the
  // result: at most 2^-53 |v| from v, 2 * 2^-53 |u| from t * u, and less than 12 * 2^-53 (|u| + |v|) from t.
  const double lost = 0x1p-49 * (std::abs(ux) + std::abs(uy) + std::abs(vx) + std::abs(vy));
  return std::sqrt(x * x + y * y) + lost;
}

}  // namespace ptin
