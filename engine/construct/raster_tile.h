// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a window of a raster.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/construct/full_surface.h"
#include "engine/construct/raster_source.h"
#include "engine/construct/tile.h"
#include "engine/construct/tile_tree.h"
#include "engine/geometry/box.h"

namespace ptin {

/// A tile with the full TIN of a window, and the full surface under it.
struct StartedTile {
  Tile tile;
  std::unique_ptr<FullSurface> full;
  GridBox box;                     ///< Of all samples and the full surface.
  std::uint64_t lone_samples = 0;  ///< Samples that touch no surface triangle; treated as void.
};

/// Constants of measuring for a terrain. @param void_slope  Height charged per ground unit of
/// depth.
[[nodiscard]] MeasureUnits measure_units(const TerrainFrame& frame, double void_slope);

/// Reads `window` (with a margin of the depth's cut-off around it where there is more), turns lone
/// samples into voids and triangulates. Tiles get the same depths and classes as the whole.
/// @throws Error as RasterSource::read, resource_exhausted
/// Cost: linear. Memory: about 200 bytes a sample.
[[nodiscard]] StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                                            const MeasureUnits& units);

}  // namespace ptin
