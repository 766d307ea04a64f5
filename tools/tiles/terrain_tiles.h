// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain as tiles for Cesium: layer.json, and quantized-mesh 1.0 in EPSG:4326 by the numbers of
// TMS. A service hands out the bytes with gzip and its header.
//
// What a tile is
// - Cesium takes a tile of level z to be off by 77 067 m / 2^z, and so it is at every sample, at most
//   (between samples, of the full TIN, by the certified deviation): TileLevel says how that is
//   divided. The finest level is built more finely (tile_levels()).
// - Vertices are those of the TIN at the level's error, transformed to EPSG:4326, and only then cut
//   at the tile's sides. Neighbours of one level have equal vertices on the side that they share:
//   position, height (quantized_mesh.h) and normal.
// - Holes of the terrain are holes of its tiles, and outside of the terrain there is nothing.
//   Tiles without any surface are not in `available`, and are no tiles, with these exceptions.
// - The two tiles of level 0 are always there, and cover the globe: Cesium draws no globe without
//   them, and fills with them what has no tiles of its own. They are flat, at height 0 of the
//   ellipsoid, which no terrain on Earth is 77 km away from. Further levels are flat, too, while a
//   tile is at least twice as large as the terrain and no height of the terrain is farther from 0
//   than the level's error: a part of a tile there would tear a hole into the globe.
// - A tile may be listed and hold no surface: where a hole of its level hides what finer levels
//   show, and of the finest levels of large files, of which nobody has looked at every tile
//   (PyramidOptions::coverage_triangles). Cesium knows no tile without triangles: it is one
//   triangle without area.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/tiles/globe.h"
#include "tools/tiles/tile_pyramid.h"

namespace ptin::tools {

struct TerrainTilesOptions {
  /// Cesium assumes heights above the ellipsoid; vertical_datum() says what the file's are.
  GlobeOptions globe;
  std::uint32_t most_vertices = 65'000;  ///< Most vertices of a tile.
  std::uint64_t coverage_triangles = 200'000;
};

/// What a client wants of a tile: numbers of TMS, y from the south.
struct TileRequest {
  std::int64_t z = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  bool normals = true;  ///< The extension octvertexnormals, where the client accepts it.
  QueryLimits limits;
};

/// Threads: const functions may be called at once.
class TerrainTiles {
 public:
  /// @param terrain  A copy of it is kept, which shares the file.
  /// @param crs      crs_facts() of the terrain's store, or what is known better.
  /// @param limits   Limits of finding out which tiles there are.
  /// @throws Error invalid_argument  as Globe
  ///               as TilePyramid
  TerrainTiles(const Terrain& terrain, const CrsFacts& crs, const TerrainTilesOptions& options,
               const QueryLimits& limits);

  /// layer.json. The template of tiles is relative to it.
  /// @param version  Version of the tiles' bytes, a part of addresses: in letters that these have.
  [[nodiscard]] nlohmann::json layer_json(const std::string& version) const;
  /// A tile; none when there is no such tile.
  /// @throws Error as TilePyramid::mesh()
  [[nodiscard]] std::optional<Tile> tile(const TileRequest& request) const;
  /// Whether there is such a tile, as `available` of layer_json() has it. Cost: a few look-ups.
  [[nodiscard]] bool has(std::int64_t z, std::int64_t x, std::int64_t y) const noexcept;

  /// The first level that is made from the terrain; those before it are flat.
  [[nodiscard]] int first_level() const noexcept { return first_level_; }
  [[nodiscard]] const TilePyramid& pyramid() const noexcept { return pyramid_; }

 private:
  TerrainTiles(const Terrain& terrain, std::shared_ptr<const Globe> globe,
               const TerrainTilesOptions& options, const QueryLimits& limits);

  int first_level_ = 1;
  TilePyramid pyramid_;
};

}  // namespace ptin::tools
