// SPDX-License-Identifier: GPL-3.0-or-later
//
// From triangles to what lies under the pixels of a view: heights, states and pages.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/query/questions.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// Heights, states and pages of the surface under the middle of each pixel.
struct TerrainRaster {
  int width = 0;
  int height = 0;
  std::vector<float> heights;  ///< NaN unless `states` says kSurface.
  std::vector<PointState> states;
  /// The page of each pixel's triangle; empty unless the TIN tells the pages of its triangles.
  std::vector<std::uint32_t> pages;

  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// A raster of the size of `view`, all of whose pixels lie outside.
[[nodiscard]] TerrainRaster empty_raster(const View& view);
/// Where the middles of the pixels of `view` stand.
[[nodiscard]] PixelLattice lattice_of(const View& view);

/// Samples the triangles of `refined` at the middles of the pixels of `view`. Cost: triangles plus
/// pixels; memory: raster_bytes_per_pixel().
/// @throws Error cancelled
[[nodiscard]] TerrainRaster rasterize(const RefinedTin& refined, const StoreFacts& facts,
                                      const View& view, const std::stop_token& stop = {});

/// Heights and states under the middle of each pixel of `view`, as questions for points would have them,
/// without a mesh.
/// @param raster  Filled.
/// @throws Error as Terrain::raster()
RasterResult sample_terrain(const Terrain& terrain, const DetailRequest& detail,
                            const QueryLimits& limits, const View& view, TerrainRaster& raster);

/// Memory of a TerrainRaster, for each pixel.
[[nodiscard]] constexpr std::uint64_t raster_bytes_per_pixel(bool has_pages) {
  return sizeof(float) + sizeof(PointState) + (has_pages ? sizeof(std::uint32_t) : 0);
}

}  // namespace ptin::tools
