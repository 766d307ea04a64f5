// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/rasterize.h"

#include "engine/mesh/tin.h"
#include "engine/stop.h"

namespace ptin::tools {

TerrainRaster empty_raster(const View& view) {
  TerrainRaster raster;
  raster.width = view.width;
  raster.height = view.height;
  const std::size_t pixels =
      static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  raster.heights.resize(pixels);
  raster.states.resize(pixels, PointState::kOutside);
  return raster;
}

RasterResult sample_terrain(const Terrain& terrain, const DetailRequest& detail,
                            const QueryLimits& limits, const View& view, TerrainRaster& raster) {
  raster = empty_raster(view);
  RasterRequest wanted;
  wanted.lattice = lattice_of(view);
  wanted.pixels = {0, 0, view.width, view.height};
  wanted.detail = detail;
  wanted.states = true;
  wanted.limits = limits;
  return terrain.raster(wanted, [&](const RasterBlock& block) {
    const PixelRect& pixels = block.pixels;
    for (std::int64_t y = 0; y < pixels.height; ++y) {
      for (std::int64_t x = 0; x < pixels.width; ++x) {
        const auto from = static_cast<std::size_t>(y) * block.stride + static_cast<std::size_t>(x);
        const std::size_t to =
            raster.place(static_cast<int>(pixels.column + x), static_cast<int>(pixels.row + y));
        raster.heights[to] = static_cast<float>(block.heights[from]);
        raster.states[to] = block.states[from];
      }
    }
  });
}

PixelLattice lattice_of(const View& view) {
  return {{view.window.min_x + (0.5 - view.left) / view.scale_x,
           view.window.max_y - (0.5 - view.top) / view.scale_y},
          1 / view.scale_x,
          -1 / view.scale_y};
}

TerrainRaster rasterize(const RefinedTin& refined, const StoreFacts& facts, const View& view,
                        const std::stop_token& stop) {
  const Tin& tin = refined.tin;
  const bool has_pages = refined.page_of_triangle.size() == tin.triangles.size();
  TerrainRaster raster = empty_raster(view);
  raster.pages.resize(has_pages ? raster.states.size() : 0);
  const PixelCentres centres(facts, lattice_of(view), {0, 0, view.width, view.height});
  PixelSampler<float> sampler(facts, centres, {raster.heights, raster.states, raster.pages});
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) stop_if_asked(stop, "drawing");
    sampler.add(living_triangle(tin, t), has_pages ? refined.page_of_triangle[t] : kNone);
  }
  return raster;
}

}  // namespace ptin::tools
