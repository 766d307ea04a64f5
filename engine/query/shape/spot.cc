// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/spot.h"

#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "engine/geometry/affine_rounding.h"

namespace ptin {

namespace {

/// Bound, in grid units, of the error with which a vertex's own map position X =
/// fl(fl(o) + fl(s g)) converts back to its grid coordinate g.
double conversion_error(double origin, double step, double grid) {
  return rounding_to_grid(origin + step * grid, origin, step, grid);
}

}  // namespace

SpotMap::SpotMap(const AffineMap& map, const GridBox& bounds) : map_(map) {
  double error = 0.0;
  for (const std::int32_t x : {bounds.min_x, bounds.max_x}) {
    error = std::max(error, conversion_error(map.origin_x, map.step_x, x));
  }
  for (const std::int32_t y : {bounds.min_y, bounds.max_y}) {
    error = std::max(error, conversion_error(map.origin_y, map.step_y, y));
  }
  while (bits_ > 0 && !(2 * error < std::ldexp(1.0, -bits_))) {
    --bits_;
  }
}

std::optional<Spot> SpotMap::spot(MapPoint p) const {
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
    refuse(
        "a coordinate of a position is not a finite number: give map units of the terrain's CRS");
  }
  const MapPoint grid = map_.to_grid(p);
  constexpr double kFarthest = 2147483648.0;
  if (!(std::abs(grid.x) <= kFarthest && std::abs(grid.y) <= kFarthest)) {
    return std::nullopt;
  }
  return rounded(grid);
}

Spot SpotMap::rounded(MapPoint grid) const noexcept {
  const double scale = std::ldexp(1.0, bits_);
  const std::int64_t unit = std::int64_t{1} << (kSpotBits - bits_);
  return {std::llrint(grid.x * scale) * unit, std::llrint(grid.y * scale) * unit};
}

}  // namespace ptin
