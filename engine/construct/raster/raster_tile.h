// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a window of a raster.
#pragma once

#include "engine/construct/raster/raster_source.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Reads `window`, turns lone samples into void ones and triangulates. Where the raster has voids,
/// a margin of kVoidDepthCutOff + 1 samples is read around the window, as far as the raster
/// reaches, so that depths and classes in a tile are those in the whole raster.
/// @throws Error as RasterSource::read, resource_exhausted
/// Cost: linear. Memory: about 200 bytes a sample.
[[nodiscard]] StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                                            const MeasureUnits& units);

}  // namespace ptin
