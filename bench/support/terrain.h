// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains in memory, ready to be simplified.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/raster/raster_tile.h"

namespace ptin::bench {

/// A tile with its full surface and its frame.
struct MadeTerrain {
  TerrainFrame frame;
  StartedTile started;
};

/// Points on the grid, as a Delaunay triangulation wants them: ascending keys, all distinct.
struct GridPoints {
  std::vector<GridPoint> positions;
  std::vector<HeightBits> heights;
};

/// The Delaunay triangulation of `points` as one tile.
[[nodiscard]] MadeTerrain terrain_of(const GridPoints& points, const TerrainFrame& frame);

/// The heights that random points are given.
enum class Relief {
  /// 48 plane waves of 1 to 128 periods a side. Amplitudes fall with the frequency; together they
  /// are 1000 m.
  kHills,
  kNoise,  ///< Independent uniform heights, 0 to 1000 m.
  kFlat,   ///< One height for all points.
};

/// `count` uniform points in the unit square (2^24 grid units a side), heights in millimetres.
[[nodiscard]] MadeTerrain random_terrain(std::size_t count, std::uint64_t seed,
                                         Relief relief = Relief::kHills);

/// The samples of a raster in a square of `side` x `side` whose south-western sample is (x0, y0),
/// cut at the border of the raster.
[[nodiscard]] MadeTerrain raster_terrain(const std::string& path, std::int64_t x0, std::int64_t y0,
                                         std::int64_t side);

/// A made raster of `side` x `side` samples with the heights of `relief`.
[[nodiscard]] MadeTerrain made_raster(std::int32_t side, Relief relief);

}  // namespace ptin::bench
