// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/tile_sets.h"

#include "engine/stop.h"
#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

/// So many triangles of a level are looked at whole: they fit the memory of a question.
constexpr std::uint64_t kCoverageTriangles = 100'000;

tools::TerrainTilesOptions tiles_options() {
  tools::TerrainTilesOptions options;
  options.coverage_triangles = kCoverageTriangles;
  return options;
}

}  // namespace

template <class Tiles, class Make>
std::shared_ptr<const Tiles> TileSets::kept_or_made(Kept<Tiles>& kept, const QueryLimits& limits,
                                                    const Make& make) {
  {
    std::unique_lock lock(kept.mutex);
    kept.is_settled.wait(lock, limits.stop, [&] { return !kept.is_sought; });
    stop_if_asked(limits.stop, "finding out which tiles there are");
    if (kept.tiles) return kept.tiles;
    kept.is_sought = true;
  }
  std::shared_ptr<const Tiles> tiles;
  const auto settle = [&] {
    const std::scoped_lock lock(kept.mutex);
    kept.tiles = tiles;
    kept.is_sought = false;
    kept.is_settled.notify_all();
  };
  try {
    tiles = make();
  } catch (const Error& error) {
    settle();
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw http::Problem(404, "this collection has no tiles: " + error.message()).at("id");
  } catch (...) {
    settle();
    throw;
  }
  settle();
  return tiles;
}

std::shared_ptr<const tools::TerrainTiles> TileSets::quantized(const Terrain& terrain,
                                                               const CrsFacts& crs,
                                                               const QueryLimits& limits) {
  return kept_or_made(quantized_, limits, [&] {
    return std::make_shared<const tools::TerrainTiles>(terrain, crs, tiles_options(), limits);
  });
}

std::shared_ptr<const tools::TerrainTileset> TileSets::tileset(const Terrain& terrain,
                                                               const CrsFacts& crs,
                                                               const QueryLimits& limits) {
  return kept_or_made(tileset_, limits, [&] {
    return std::make_shared<const tools::TerrainTileset>(terrain, crs, tiles_options(), limits);
  });
}

std::shared_ptr<const tools::MercatorPyramid> TileSets::mercator(const Terrain& terrain,
                                                                 const CrsFacts& crs,
                                                                 const QueryLimits& limits) {
  return kept_or_made(mercator_, limits,
                      [&] { return std::make_shared<const tools::MercatorPyramid>(terrain, crs); });
}

}  // namespace ptin::serve
