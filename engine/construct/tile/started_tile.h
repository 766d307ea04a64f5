// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile before its first collapse, whatever its source.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"
#include "engine/geometry/convex_hull.h"

namespace ptin {

/// Samples of a raster in and around a window, row by row from the south-west.
struct SurroundingSamples {
  GridBox box;
  std::vector<HeightBits> heights;
  std::vector<std::uint8_t> valid;  ///< 1 for each of `heights`, 0 for a sample without one.
};

/// A leaf with the full TIN of its window, and the full surface under it.
struct StartedTile {
  Tile tile;
  std::unique_ptr<FullSurface> full;
  GridBox box;                     ///< Holds all samples and the full surface.
  std::uint64_t lone_samples = 0;  ///< Samples that touch no surface triangle; treated as void.
  SurroundingSamples around;       ///< Where they were asked for; else empty.
};

/// The lengths of grid steps on the ground, at least those of each row of the box.
/// Larger by a thousandth at most, unless all have the same steps.
[[nodiscard]] GroundStep largest_step(const GroundMetric& ground, const GridBox& rows);

/// Starts a leaf of points or of a TIN: its mesh is `part`, the triangles that are its own.
/// @param hull    Hull of the whole terrain.
/// @param ground  Null: the terrain has no voids.
/// @param fixed_sides  As FixedGaps has them; empty: no breaklines.
[[nodiscard]] StartedTile start_part(Tin&& part, const MeasureUnits& units, const ConvexHull& hull,
                                     const GroundMetric* ground,
                                     std::span<const std::uint8_t> fixed_sides = {});

/// Constants of measuring for a terrain.
/// @param void_slope  Height charged per ground unit that the border moves.
[[nodiscard]] MeasureUnits measure_units(const TerrainFrame& frame, double void_slope);

}  // namespace ptin
