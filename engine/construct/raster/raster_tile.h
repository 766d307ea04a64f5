// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a window of a raster.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Samples of a raster: those of a window, and where the raster has voids or they are asked for those
/// of a margin around it, in which the border between surface and void is looked for.
struct RasterSamples {
  SampleRange raster;  ///< All there are.
  SampleRange range;   ///< Those that are here: range_around() a window, or the window.
  std::vector<HeightBits> heights;  ///< Row-major, row 0 in the south.
  std::vector<std::uint8_t> valid;  ///< 1 for each of `heights`, 0 for a sample without one.
  bool has_voids = false;           ///< The raster has, if not these samples.
  GroundStep step;  ///< As PartOfTerrain::step; of no account where all samples have heights.
  bool keep_around = false;  ///< All of these are asked for as StartedTile::around.
};

/// A window with its margin, as far as the raster reaches.
[[nodiscard]] SampleRange range_around(const SampleRange& raster, const SampleRange& window);

/// Reads `window`, with a margin where the raster has voids, and starts the leaf.
/// @param keep_around  Gives the leaf the samples around it too (StartedTile::around).
/// @throws Error as RasterSource::read, resource_exhausted
/// Cost: linear but for the witnesses of the border, n log n. Memory: about 200 bytes a sample; where
/// a border is in reach about 100 more, and by the sizes of what it holds 400 more while it runs.
[[nodiscard]] StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                                            const MeasureUnits& units, bool keep_around = false);

/// Turns lone samples into void ones, triangulates, and finds the witnesses of the border.
[[nodiscard]] StartedTile start_raster_tile(RasterSamples&& samples, const SampleRange& window,
                                            const MeasureUnits& units);

}  // namespace ptin
