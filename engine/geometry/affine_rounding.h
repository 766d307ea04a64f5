// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rounding does to a coordinate on its way from the map to the grid.
#pragma once

#include <cmath>
#include <limits>

namespace ptin {

/// A bound, in grid units, for one coordinate `grid` = (map_value - origin) / step in doubles, on
/// its distance to the true preimage of every map position that rounds to `map_value`: the
/// quotient carries at most 2u |grid| (1 + u) of rounding, u = 2^-53, and map_value itself, when it
/// was computed as origin + step g, at most u (|map_value| + |map_value - origin|) of its own.
/// Twice the sum of both is taken.
[[nodiscard]] inline double rounding_to_grid(double map_value, double origin, double step,
                                             double grid) noexcept {
  return 2 * std::numeric_limits<double>::epsilon() *
         ((std::abs(map_value) + std::abs(origin)) / step + std::abs(grid));
}

}  // namespace ptin
