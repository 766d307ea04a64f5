// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN sampled into a GeoTIFF or a COG, block by block.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/terrain.h"
#include "tools/export/pixel_grid.h"

namespace ptin::tools {

struct RasterTarget {
  std::string path;
  bool overwrite = false;
  bool is_cog = false;
  double nodata = -9999.0;
  std::vector<std::string> creation_options;  ///< KEY=VALUE for the driver; override ours.
  CrsFacts crs;
  std::uint64_t buffer_bytes = std::uint64_t{64} << 20;  ///< For pixels and GDAL's cache, each.
  std::uint64_t table_bytes = std::uint64_t{64} << 20;   ///< For GDAL's table of blocks.
};

/// Samples the TIN of `refiner` at the centres of `grid` and writes it: Float32, or Float64 where
/// Float32 does not hold every height of a vertex. Where there is no surface: nodata.
///
/// Returns how far a written height is from that of the TIN at most: what Float32 rounds between
/// vertices.
///
/// Blocks are sampled together as far as memory allows, and written in an order that depends on the
/// size of the raster alone. A COG is copied by GDAL from a GeoTIFF beside it, with its overviews.
/// @param progress  Share done, 0 to 1; may be empty.
/// @throws Error  invalid_argument    GDAL refuses an option, or the output exists
///                resource_exhausted  what a single pixel needs does not fit; so many blocks that
///                                    their table does not; disk full
///                as PartRefiner::refine; io_error; cancelled. Nothing is left behind.
[[nodiscard]] double export_raster(const PartRefiner& refiner, const PixelGrid& grid,
                                   const RasterTarget& target,
                                   const std::function<void(double)>& progress);

/// A value for pixels without a height: -9999, or one below every height when the terrain has it.
[[nodiscard]] double default_nodata(const StoreFacts& facts) noexcept;

}  // namespace ptin::tools
