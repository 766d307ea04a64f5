// SPDX-License-Identifier: GPL-3.0-or-later
//
// How deep a sample lies in its class (its distance on the ground to the other class), by brute
// force; for verification.
#pragma once

#include "engine/crs/ground.h"
#include "engine/geometry/affine.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// The lengths of a grid step on the ground: in metres, at one row, where the CRS is in angles;
/// else in map units.
struct GroundSteps {
  double x = 1.0;
  double y = 1.0;
};
[[nodiscard]] GroundSteps ground_steps(const AffineMap& map, const Ground& ground, double grid_y);

/// The distance on the ground from grid point (x, y) to the nearest sample of the other class in
/// `window`, measured by the steps of one row; +infinity when there is none within `limit`.
/// REQUIRES: window.is_grid, and (x, y) in it. Cost: the square of the distance in samples.
[[nodiscard]] double depth_at(const SampleWindow& window, std::int32_t x, std::int32_t y,
                              const GroundSteps& steps, double limit);

/// Makes samples void that have a height but touch no surface triangle: none of the cells around
/// them has three corners with heights. Samples on the border of `window` are judged by the cells
/// inside of it.
void drop_lone_samples(SampleWindow& window);

}  // namespace ptin::tools
