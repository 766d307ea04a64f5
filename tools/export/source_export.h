// SPDX-License-Identifier: GPL-3.0-or-later
//
// The raster that a terrain was built from, written again: each number bit for bit.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "engine/query/questions.h"
#include "storage/floor.h"
#include "tools/export/raster_file.h"

namespace ptin::tools {

/// A source that comes back from its terrain.
struct SourceRaster {
  const Floor* floor = nullptr;  ///< Borrowed from the terrain.
  RasterForm form;
};

/// The raster that a terrain was built from.
/// @throws Error  invalid_argument  the terrain has no samples of a raster, or something of the raster
///                                  was not kept; the message says what
///                corruption        what the metadata say of it means nothing; as StoreFile::floor()
[[nodiscard]] SourceRaster source_raster_of(const Terrain& terrain, const CrsFacts& crs);

/// Writes the raster: size, place, type, nodata value and samples, lone ones too, are those of the
/// source; blocks, tags and overviews are not. Its CRS is that of the terrain.
/// @param progress  Called with the share done, 0 to 1; may be empty.
/// @throws Error  invalid_argument    GDAL refuses an option, or the output exists
///                resource_exhausted  the table of blocks does not fit; the disk is full
///                corruption, io_error, cancelled. Nothing is left behind.
/// Cost: the floor, once but for the tiles across the sides of blocks. Memory: a block.
void export_source(const Terrain& terrain, const SourceRaster& source, const RasterTarget& target,
                   const std::function<void(double)>& progress, const std::stop_token& stop);

}  // namespace ptin::tools
