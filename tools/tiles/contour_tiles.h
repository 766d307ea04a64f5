// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contours as vector tiles of web maps (Mapbox Vector Tile 2.1), layer `contours`: a feature a level
// with `ele`, its height in metres above the datum of the terrain's heights, and `index`, true of
// every fifth level.
//
// - The lines are those of the TIN of the level of pixels one beyond the zoom, as tiles of 512 pixels
//   are shown (mercator_pyramid.h), and of the full TIN from there on. Higher ground lies to their right.
// - Lines are drawn, and not certified: what the rounding of positions is in height is known to the
//   slopes alone. Positions are rounded to 4096 steps along a tile, on one lattice of all tiles of a zoom, and lines go
//   on to 64 steps beside the tile. Where a line crosses the sides of tiles it has a point, computed
//   from the ends of its segment alone: neighbours have the same points there, and beside it.
// - Segments that are bent on the map are divided until they leave it by at most a quarter of a step.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/query/questions.h"
#include "tools/tiles/mercator_pyramid.h"

namespace ptin::tools {

/// Metres between the levels of a zoom, so that lines on a mountain's side stand some pixels apart: 1000
/// up to zoom 6, then 500, 200, 200, 100, 100, 50, 50, 20, 20, 10, 5, 2, and 1 from zoom 19 on. On low
/// land less: 1, 2 or 5 times a power of ten of which the terrain's relief has four or more.
/// @param relief  Metres from the lowest height to the highest.
[[nodiscard]] double contour_interval(int zoom, double relief) noexcept;

/// The last zoom that has tiles: three beyond that of the full TIN, where lines stand closer.
[[nodiscard]] int last_contour_zoom(const MercatorPyramid& pyramid) noexcept;

/// A vector tile, and what it cost.
struct ContourTile {
  std::string bytes;  ///< Not compressed.
  QueryCost cost;
};

/// A tile; none where it does not meet the box around the terrain, or is beyond the last zoom. Without a
/// line it has no layer, and no byte.
/// @param interval  Metres; none: that of the zoom.
/// @throws Error invalid_argument    the interval has more than 1000 levels in the terrain's heights
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: the TIN's pages around the tile, and for each point what PROJ takes.
[[nodiscard]] std::optional<ContourTile> contour_tile(const MercatorPyramid& pyramid,
                                                      const WebTile& tile,
                                                      std::optional<double> interval,
                                                      const QueryLimits& limits);

/// What TileJSON tells of the tiles: vector_layers, zooms, bounds, the interval of each zoom.
/// @throws Error invalid_argument  as contour_tile()
[[nodiscard]] nlohmann::json contour_facts(const MercatorPyramid& pyramid,
                                           std::optional<double> interval);

}  // namespace ptin::tools
