// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much ground lies near the border between surface and void.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"
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

/// A side of a triangle.
struct BorderSide {
  VertexKey low, high;  ///< Its ends.
  bool is_void;         ///< The triangle's class.
};

/// Adds the edges between surface and void whose lower end (by key) lies in `tile`, and the parts of
/// the border that begin there.
/// @param sides  Sides of the level's triangles, at least those with an end in the tile. Sorted.
void add_border(std::vector<BorderSide>& sides, const GridBox& tile, const PlaneArea& plane,
                const BorderScope& scope, BorderLength& border);

}  // namespace ptin
