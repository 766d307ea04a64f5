// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tiles of a collection, found out when they are first asked for.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/tiles/mercator_pyramid.h"
#include "tools/tiles/terrain_tiles.h"
#include "tools/tiles/terrain_tileset.h"

namespace ptin::serve {

/// Which tiles there are takes a second or so to find out, so that is done once. Threads: any.
class TileSets {
 public:
  /// For Cesium.
  /// Waits while another question finds out.
  /// @throws http::Problem 404  the terrain has no place on the globe; told why
  ///         Error as tools::TerrainTiles
  [[nodiscard]] std::shared_ptr<const tools::TerrainTiles> quantized(const Terrain& terrain,
                                                                     const CrsFacts& crs,
                                                                     const QueryLimits& limits);
  /// As 3D Tiles.  @throws as quantized()
  [[nodiscard]] std::shared_ptr<const tools::TerrainTileset> tileset(const Terrain& terrain,
                                                                     const CrsFacts& crs,
                                                                     const QueryLimits& limits);

  /// For web maps.  @throws as quantized()
  [[nodiscard]] std::shared_ptr<const tools::MercatorPyramid> mercator(const Terrain& terrain,
                                                                       const CrsFacts& crs,
                                                                       const QueryLimits& limits);

 private:
  template <class Tiles>
  struct Kept {
    std::mutex mutex;
    std::condition_variable_any is_settled;
    bool is_sought = false;  ///< A question finds out at this moment.
    std::shared_ptr<const Tiles> tiles;
  };
  /// @param make  Makes what is not kept yet, as a shared pointer.
  template <class Tiles, class Make>
  static std::shared_ptr<const Tiles> kept_or_made(Kept<Tiles>& kept, const QueryLimits& limits,
                                                   const Make& make);
  Kept<tools::TerrainTiles> quantized_;
  Kept<tools::TerrainTileset> tileset_;
  Kept<tools::MercatorPyramid> mercator_;
};

}  // namespace ptin::serve
