// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shaded relief: light from the north-west, 45 degrees high, over colours by height or by page.
#pragma once

#include <stop_token>

#include "tools/plot/image.h"
#include "tools/render/rasterize.h"
#include "tools/render/view.h"

namespace ptin::tools {

constexpr Colour kVoidColour{228, 228, 230};
constexpr Colour kHatchColour{202, 202, 206};  ///< Of the lines over voids.
constexpr Colour kWaterColour{158, 190, 212};

/// How heights become colours and slopes become shades; chosen from what is visible.
struct ReliefStyle {
  float low = 0.0F;  ///< Height of the lowest colour; lower heights have it too.
  /// Height of the highest colour; higher heights have it too. Below `low`: there is no surface.
  float high = 1.0F;
  bool any_below = false, any_above = false;  ///< There are lower or higher heights.
  bool any_water = false, any_void = false;   ///< Some is seen.
  int hatching = 9;                           ///< Pixels of the picture from line to line of voids.
  /// The factor of heights in the shading; more than 1 where the terrain is flat.
  double exaggeration = 1.0;
  bool by_page = false;  ///< Colours show the page that a triangle came from.
  /// Slopes are taken over this many pixels of the raster to each side: about the spacing of
  /// samples, so that single facets of a dense TIN do not show. 1 shows every facet.
  int reach = 1;
};

/// A style for what `raster` shows. The colours end where 98 % of the ground does, and as far again as
/// that is from the middle height: a few samples beyond all others, as of birds or towers in point
/// clouds, take no colours from the rest.
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
