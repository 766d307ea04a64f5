// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights as colours of tiles of web maps ("terrain-RGB"): what MapLibre, Mapbox, deck.gl and others
// take as raster-dem.
//
// What a tile is
// - EPSG:3857, XYZ numbers, 256 or 512 pixels along a side. A pixel has the height of its centre, on
//   the TIN of its level (mercator_pyramid.h), as locate() gives it, in metres above the datum of the
//   terrain's heights, which is not changed. It depends on the pixel alone: a tile of 512 pixels is the
//   four tiles of 256 of the next zoom, and neighbours never disagree.
// - mapbox: -10000 m + 0.1 m * (65536 red + 256 green + blue). terrarium: 256 m * red + green + blue / 256
//   - 32768 m. Heights are rounded to the nearest step; what an encoding does not hold is
//   refused for the whole terrain, told by its lowest and highest height.
// - Where there is no surface a pixel has the colour of 0 m: transparent, for clients that look at
//   opacity, or opaque (`filled`), as clients show what no tile covers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "engine/query/questions.h"
#include "tools/tiles/mercator_pyramid.h"
#include "tools/tiles/tile_image.h"

namespace ptin::tools {

enum class HeightCode : std::uint8_t { kMapbox, kTerrarium };

/// How heights become tiles.
struct HeightTileStyle {
  HeightCode code = HeightCode::kMapbox;
  TileFormat format = TileFormat::kPng;
  int side = 256;            ///< 256 or 512 pixels.
  bool fills_voids = false;  ///< Pixels without surface are opaque.

  /// How many levels the pixels of a zoom are beyond the zoom.
  [[nodiscard]] int beyond_zoom() const noexcept { return side == 512 ? 1 : 0; }
};

/// As parameters and documents name it: "mapbox", "terrarium"; "png", "webp".
[[nodiscard]] std::string_view name_of(HeightCode code) noexcept;
[[nodiscard]] std::string_view name_of(TileFormat format) noexcept;
/// The media type.
[[nodiscard]] std::string_view media_of(TileFormat format) noexcept;
/// Metres from one height to the next.
[[nodiscard]] double step_of(HeightCode code) noexcept;

/// @throws Error invalid_argument  the encoding does not hold the terrain's heights
void check_heights(const MercatorPyramid& pyramid, HeightCode code);

/// The last zoom that has tiles: its pixels are about as large as the source's samples.
[[nodiscard]] int last_zoom(const MercatorPyramid& pyramid, const HeightTileStyle& style) noexcept;

/// A tile; none where it does not meet the box around the terrain, or is beyond the last zoom.
/// @throws Error as heights_at(); resource_exhausted also where the pixels do not fit the memory
/// Cost: some ms for the TIN's pages, then about 10 ms for 256 x 256 pixels.
[[nodiscard]] std::optional<Tile> height_tile(const MercatorPyramid& pyramid,
                                              const HeightTileStyle& style, const WebTile& tile,
                                              const QueryLimits& limits);

/// What TileJSON 3.0.0 and the metadata of PMTiles both tell of the tiles: encoding, bounds, zooms,
/// unit, datum's name unchanged, attribution, and of each zoom the error that is certain.
[[nodiscard]] nlohmann::json height_facts(const MercatorPyramid& pyramid,
                                          const HeightTileStyle& style);

}  // namespace ptin::tools
