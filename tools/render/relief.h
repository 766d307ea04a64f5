// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies under the pixels of a view, and shaded relief of it: light from the north-west, 45 degrees
// high, over colours by height or by page.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/query/questions.h"
#include "tools/plot/image.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// What lies under the middle of each pixel.
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

/// Samples the triangles of `refined` at the middles of the pixels of `view`. Cost: triangles plus
/// pixels; memory: raster_bytes_per_pixel().
/// @throws Error cancelled
[[nodiscard]] TerrainRaster rasterize(const RefinedTin& refined, const StoreFacts& facts,
                                      const View& view, const std::stop_token& stop = {});

/// Memory of a TerrainRaster, for each pixel.
[[nodiscard]] constexpr std::uint64_t raster_bytes_per_pixel(bool has_pages) {
  return sizeof(float) + sizeof(PointState) + (has_pages ? sizeof(std::uint32_t) : 0);
}

/// How heights become colours and slopes become shades; chosen from what is visible.
struct ReliefStyle {
  float low = 0.0F;  ///< Height of the lowest colour; lower heights have it too.
  /// Height of the highest colour; higher heights have it too. Below `low`: there is no surface.
  float high = 1.0F;
  bool any_below = false, any_above = false;  ///< There are lower or higher heights.
  /// The factor of heights in the shading; more than 1 where the terrain is flat.
  double exaggeration = 1.0;
  bool by_page = false;  ///< Colours show the page that a triangle came from.
  /// Slopes are taken over this many pixels of the raster to each side: about the spacing of
  /// samples, so that single facets of a dense TIN do not show. 1 shows every facet.
  int reach = 1;
};

/// A style for what `raster` shows.
/// @param reach  ReliefStyle::reach; 1 shows every facet.
[[nodiscard]] ReliefStyle choose_style(const TerrainRaster& raster, const View& view, bool by_page,
                                       int reach);

/// The colour of a height, unshaded.
[[nodiscard]] Colour height_colour(float height, const ReliefStyle& style);

/// Draws `raster` (of supersampled(view, factor)) into an image of `view`. Voids are light grey and
/// hatched, water (flat at height 0) is blue, what lies outside of the terrain is white.
/// @throws Error cancelled
[[nodiscard]] Image draw_relief(const TerrainRaster& raster, const View& view, int factor,
                                const ReliefStyle& style, const std::stop_token& stop = {});

}  // namespace ptin::tools
