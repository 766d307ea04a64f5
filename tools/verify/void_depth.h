// SPDX-License-Identifier: GPL-3.0-or-later
//
// How deep a sample lies in its class, by brute force; for verification.
#pragma once

#include "engine/crs/ground.h"
#include "engine/geometry/affine.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// Lengths of a grid step on the ground: metres at a row of angles, else map units.
struct GroundSteps {
  double x = 1.0;
  double y = 1.0;
};
[[nodiscard]] GroundSteps ground_steps(const AffineMap& map, const Ground& ground, double grid_y);

/// The distance on the ground from grid point (x, y) to the nearest sample of the other class in
/// `window`, all of one row's steps; +infinity when there is none within `limit`. REQUIRES:
/// window.is_grid, and (x, y) in it. Cost: the square of the distance in samples.
[[nodiscard]] double depth_at(const SampleWindow& window, std::int32_t x, std::int32_t y,
                              const GroundSteps& steps, double limit);

/// Makes samples void that have a height but touch no surface triangle: no cell around them has
/// three corners with heights. Samples on the border of `window` are judged by what lies inside of
/// it.
void drop_lone_samples(SampleWindow& window);

}  // namespace ptin::tools
