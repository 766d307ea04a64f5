// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain as web maps divide the world: which tiles there are, the level of detail of each level of
// pixels, and where pixels stand on the terrain's map.
//
// The level of detail follows the pixel, whatever the tile: pixels of level L are 156543 m / 2^L wide at
// the equator, and tiles of 256 of them at zoom z, or of 512 at z - 1, are cut from the same pixels. The
// certified error of their TIN is a 16th of that width at most: a slope of a pixel's length is off by a
// few percent, less than shading shows. The finest level, whose pixel is about a sample of the source, has
// the full TIN.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/tiles/globe.h"
#include "tools/tiles/tile_pyramid.h"
#include "tools/tiles/web_mercator.h"

namespace ptin::tools {

/// The TIN of a level of pixels.
struct PixelLevel {
  DetailRequest detail;  ///< Nothing is set for the full TIN.
  double error = 0.0;    ///< Its certified error at the samples, metres.
};

/// Threads: const functions may be called at once.
class MercatorPyramid {
 public:
  /// @param terrain  A copy of it is kept, which shares the file.
  /// @param crs      crs_facts() of the terrain's store, or what is known better.
  /// @throws Error invalid_argument  as Globe; the terrain lies beyond the latitudes of web maps
  /// Cost: that of Globe.
  MercatorPyramid(const Terrain& terrain, const CrsFacts& crs);

  [[nodiscard]] const Terrain& terrain() const noexcept { return terrain_; }
  [[nodiscard]] const Globe& globe() const noexcept { return *globe_; }
  [[nodiscard]] int finest_level() const noexcept { return static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const PixelLevel& level(int pixels) const {
    return levels_.at(static_cast<std::size_t>(pixels));
  }
  /// Where the terrain lies, degrees, within the latitudes of web maps; west is above east across the
  /// antimeridian.
  [[nodiscard]] GlobeBox bounds() const noexcept;
  /// Facts that TileJSON and PMTiles both tell of the tiles: `bounds`, which must not lie across the antimeridian
  /// and go around the Earth where the terrain does, `center` (longitude, latitude, zoom), zooms, and
  /// `attribution` as HTML, which clients take it for.
  /// @param last_zoom  From 0 on.
  [[nodiscard]] nlohmann::json place_facts(int last_zoom) const;
  /// The terrain's metadata name who is to be named where it is shown; empty: nobody.
  [[nodiscard]] const std::string& attribution() const noexcept { return attribution_; }

  /// Whether a tile meets the box around the terrain. Any numbers may be asked for.
  [[nodiscard]] bool has(std::int64_t z, std::int64_t x, std::int64_t y) const noexcept;
  /// The tiles of a zoom that do, as rectangles that do not overlap.  REQUIRES: 0 <= z <= 30
  [[nodiscard]] std::vector<TileRectangle> rectangles(int z) const;
  /// The column of a tile where columns are counted on beyond the antimeridian, to where the terrain lies.
  /// REQUIRES: has()
  [[nodiscard]] std::int64_t unrolled_column(const WebTile& tile) const noexcept;

  /// Where the centres of a square of pixels stand, map units, row by row; not finite where they lie
  /// beside the box around the terrain. Each depends on its pixel alone: it is what PROJ gives, or,
  /// in squares of 16 pixels where that is within 0.1 mm of it at nine places, a cubic through what PROJ
  /// gives for every 16th pixel.
  /// @param column, row  Of the first pixel of the level, columns unrolled: multiples of 16.
  /// @param side         Of the square, a multiple of 16.
  /// REQUIRES: centres has side * side places
  void place_pixels(int level, std::int64_t column, std::int64_t row, std::int64_t side,
                    std::span<MapPoint> centres) const;

 private:
  [[nodiscard]] int level_of_samples() const;

  Terrain terrain_;
  std::shared_ptr<const Globe> globe_;
  double most_off_ = 0.0;  ///< 0.1 mm over ground, map units; 0 where nobody knows the unit.
  GlobeBox box_;           ///< Longitudes go on beyond 180.
  MapPoint low_,
      high_;  ///< The box as shares of the world: north-western and south-eastern corners.
  std::string attribution_;
  std::vector<PixelLevel> levels_;
};

}  // namespace ptin::tools
