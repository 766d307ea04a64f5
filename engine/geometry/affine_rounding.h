// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rounding does to a coordinate on its way from the map to the grid.
#pragma once

#include <algorithm>
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

/// The grid position of one coordinate; where `map_value` is the map position of a whole number, up
/// to rounding, that number. Rounding is that of rounding_to_grid(), and that of a number that was
/// written with 15 digits, as programs write them: 5e-15 of the number. It never moves a position by
/// more than a thousandth of a grid unit.
[[nodiscard]] inline double snapped_to_grid(double map_value, double origin, double step) noexcept {
  constexpr double kDigits = 5e-15;
  constexpr double kMost = 0x1p-10;
  const double grid = (map_value - origin) / step;
  const double whole = std::round(grid);
  const double slack =
      rounding_to_grid(map_value, origin, step, grid) + kDigits * (std::abs(map_value) / step);
  return std::abs(grid - whole) <= std::min(slack, kMost) ? whole : grid;
}

}  // namespace ptin
