// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rounding does to a coordinate on its way from the map to the grid.
#pragma once

#include <cmath>
#include <limits>

namespace ptin {

/// Bounds what rounding does to one coordinate, in grid units. `grid` = (map_value - origin) /
/// step, as doubles compute it. The bound holds for the distance from `grid` to the exact grid
/// position of every real number that rounds to `map_value`.
///
/// Two roundings add up; u = 2^-53. Subtraction and quotient cost at most 2u |grid| (1 + u). Where
/// map_value was computed as origin + step * g, it carries at most u (|map_value| + |map_value -
/// origin|) map units of its own. The result is at least twice the sum of both.
[[nodiscard]] inline double rounding_to_grid(double map_value, double origin, double step,
                                             double grid) noexcept {
  return 2 * std::numeric_limits<double>::epsilon() *
         ((std::abs(map_value) + std::abs(origin)) / step + std::abs(grid));
}

}  // namespace ptin
