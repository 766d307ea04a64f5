// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much ground lies near the border between surface and void.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/region.h"
#include "engine/query/volume/fixed_sum.h"
#include "engine/query/volume/plane_area.h"

namespace ptin {

/// The border of a TIN, added up tile by tile: its length, and no fewer than its connected parts.
///
/// All points within r of a connected curve of length l cover at most 2 r l + pi r^2: a disc that
/// moves along the curve begins with its own area, and sweeps over at most 2 r dl of new ground.
/// Every part has a vertex that comes first among its neighbours along the border, and whether one
/// does shows in its star: so what is counted does not depend on the tiles.
struct BorderLength {
  FixedSum length;  ///< Ground units.
  std::uint64_t parts = 0;

  /// No less than the area within `reach` ground units of the border.
  [[nodiscard]] double area_within(double reach) const;
};

/// Which edges of the border are counted: those whose box, widened by `reach` (grid units along x and
/// y), meets the region.
struct BorderScope {
  const GridRegion* region = nullptr;  ///< Null: all.
  MapPoint reach;
};

/// Adds the edges of `tin` between surface and void whose lower end (by key) lies in `tile`, and the
/// parts of the border that begin there. REQUIRES: triangles that meet the tile are those of the
/// level.
void add_border(const Tin& tin, const GridBox& tile, const PlaneArea& plane,
                const BorderScope& scope, BorderLength& border);

}  // namespace ptin
