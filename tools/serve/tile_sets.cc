// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/tile_sets.h"

#include "engine/stop.h"
#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

/// So many triangles of a level are looked at whole: they fit the memory of a question.
constexpr std::uint64_t kCoverageTriangles = 100'000;

}  // namespace

template <class Tiles>
std::shared_ptr<const Tiles> TileSets::made(Kept<Tiles>& kept, const Terrain& terrain,
                                            const CrsFacts& crs, const QueryLimits& limits) {
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
    tools::TerrainTilesOptions options;
    options.coverage_triangles = kCoverageTriangles;
    tiles = std::make_shared<const Tiles>(terrain, crs, options, limits);
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
  return made(quantized_, terrain, crs, limits);
}

std::shared_ptr<const tools::TerrainTileset> TileSets::tileset(const Terrain& terrain,
                                                               const CrsFacts& crs,
                                                               const QueryLimits& limits) {
  return made(tileset_, terrain, crs, limits);
}

}  // namespace ptin::serve
