// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a window of a raster.
#pragma once

#include "engine/construct/raster/raster_source.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Reads `window` (with a margin of the depth's cut-off around it where there is more), turns lone
/// samples into voids and triangulates. Tiles get the same depths and classes as the whole.
/// @throws Error as RasterSource::read, resource_exhausted
/// Cost: linear. Memory: about 200 bytes a sample.
[[nodiscard]] StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                                            const MeasureUnits& units);

}  // namespace ptin
