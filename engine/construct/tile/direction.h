// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points infinitely near a vertex: a vertex and one of eight directions.
#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A compass direction, 1 to 8; 0 is none. A position with a direction stands for the points that
/// lie infinitely near it in that direction. So a triangle can be named by a point of its inside
/// although no grid point lies there.
using Direction = std::uint16_t;
inline constexpr Direction kNoDirection = 0;
inline constexpr Direction kDirections = 8;

/// The step of a direction on the grid.
struct DirectionStep {
  std::int32_t x, y;
};
[[nodiscard]] constexpr DirectionStep step_of(Direction d) noexcept {
  constexpr std::array<DirectionStep, kDirections + 1> kSteps{
      {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  return kSteps[d];
}

/// As orient(a, b, p), where p + d stands for p: the sign alone has a meaning.
[[nodiscard]] constexpr std::int64_t orient_towards(GridPoint a, GridPoint b, GridPoint p,
                                                    Direction d) noexcept {
  const std::int64_t abx = std::int64_t{b.x} - a.x;
  const std::int64_t aby = std::int64_t{b.y} - a.y;
  const std::int64_t side = abx * (std::int64_t{p.y} - a.y) - aby * (std::int64_t{p.x} - a.x);
  return side != 0 ? side : abx * step_of(d).y - aby * step_of(d).x;
}

/// True when the points infinitely near `p` in direction `d` lie in the closed triangle.
[[nodiscard]] inline bool triangle_holds(const Tin& tin, const Triangle& triangle, GridPoint p,
                                         Direction d) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (orient_towards(tin.position(triangle.v[i]), tin.position(triangle.v[next_corner(i)]), p,
                       d) < 0) {
      return false;
    }
  }
  return true;
}

/// A corner of a triangle and a direction that leads from it into the triangle.
struct WayIn {
  int corner = 0;
  Direction direction = kNoDirection;
};

/// The way into a counter-clockwise triangle from the corner with the largest angle. That is at
/// least 60 degrees, so one of the eight directions lies strictly inside of it.
[[nodiscard]] WayIn way_into(const std::array<GridPoint, 3>& corners) noexcept;

}  // namespace ptin
