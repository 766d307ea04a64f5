// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN sampled into a GeoTIFF or a COG, block by block: its heights, or how its triangles lie.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/query/questions.h"
#include "tools/export/raster_file.h"

namespace ptin::tools {

/// What was written.
struct WrittenRaster {
  /// The largest distance of a written height from that of the TIN: what Float32 rounds between
  /// vertices; 0 of what is no height.
  double rounding = 0.0;
  std::uint64_t surface_pixels = 0;  ///< Pixels whose centre lies on surface.
  /// Bounds of what the pixels are from the source's, as RasterResult has them, the rounding included.
  double certified_error = 0.0, certified_deviation = 0.0;
  bool exact = false;  ///< Nothing was left out, and nothing rounded.
  QueryCost cost;
};

/// Samples the terrain as `request` says and writes what `target.content` names, in pixels of
/// type_of_pixels(). A pixel without a value gets `nodata`.
///
/// Blocks are sampled together as far as memory allows, and written in an order that depends on the
/// size of the raster alone. A COG is copied by GDAL, with its overviews, from a GeoTIFF beside it.
/// @param request   Its rows run to the south. What it asks for, the size of its blocks and its
///                  progress are set here.
/// @param progress  Called with the share done, 0 to 1; may be empty.
/// @throws Error  invalid_argument    GDAL refuses an option, or the output exists
///                resource_exhausted  the table of blocks does not fit `table_bytes`; the disk is
///                                    full
///                as Terrain::raster; io_error; cancelled. Nothing is left behind.
[[nodiscard]] WrittenRaster export_raster(const Terrain& terrain, RasterRequest request,
                                          const RasterTarget& target,
                                          const std::function<void(double)>& progress);

}  // namespace ptin::tools
