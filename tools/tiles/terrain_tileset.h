// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain as 3D Tiles 1.1: tileset.json with implicit tiling, subtrees, and tiles as GLB.
//
// - The root is a box in longitude and latitude around the terrain and around all contents: their
//   positions are rounded, and their triangles are flat on a curved Earth. Each tile has four
//   children, and its content may leave its share of the root's region, into that of a neighbour, by
//   a position_step() and half as much again as TileLevel::chord, as neighbours share what is cut.
//   A tile of level L lies within tileset.json's geometric error of the root / 2^L of the terrain,
//   certified: it is made from the TIN of less than that. The root's is what the file certifies for
//   its coarsest TIN, or a 64th of the terrain's extent where that is less. The finest level is
//   built more finely (tile_levels()).
// - Neighbours of one level have equal vertices on the side that they share: position and normal,
//   as doubles (tile_glb.h). Holes are holes, and nothing is outside of the terrain.
// - Tiles that hold no surface have no content, and where nothing below them does either they are
//   not available. Nobody has looked at every tile of the finest levels of large files
//   (PyramidOptions::coverage_triangles): a content of those may be an empty scene.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/tiles/terrain_tiles.h"
#include "tools/tiles/tile_pyramid.h"

namespace ptin::tools {

/// Threads: const functions may be called at once.
class TerrainTileset {
 public:
  /// As TerrainTiles.
  TerrainTileset(const Terrain& terrain, const CrsFacts& crs, const TerrainTilesOptions& options,
                 const QueryLimits& limits);

  /// Subtrees hold so many levels.
  static constexpr int kSubtreeLevels = 5;

  /// tileset.json. Its templates are relative: subtrees/{level}/{x}/{y}.subtree and
  /// content/{level}/{x}/{y}.glb.
  [[nodiscard]] nlohmann::json tileset_json() const;
  /// The bytes of the subtree below a tile; none when there is no such subtree.
  [[nodiscard]] std::optional<std::string> subtree(std::int64_t level, std::int64_t x,
                                                   std::int64_t y) const;
  /// A tile's content, y counted from the south; none when the tile has none.
  /// @throws Error as TilePyramid::mesh()
  [[nodiscard]] std::optional<Tile> content(std::int64_t level, std::int64_t x, std::int64_t y,
                                            const QueryLimits& limits) const;

  /// Whether there is such a tile. The root always is.
  [[nodiscard]] bool has_tile(std::int64_t level, std::int64_t x, std::int64_t y) const noexcept;
  [[nodiscard]] bool has_content(std::int64_t level, std::int64_t x, std::int64_t y) const noexcept;
  /// Positions of a level's tiles are multiples of this, metres.
  [[nodiscard]] double position_step(int level) const;
  [[nodiscard]] const TilePyramid& pyramid() const noexcept { return pyramid_; }

 private:
  TerrainTileset(const Terrain& terrain, std::shared_ptr<const Globe> globe,
                 const TerrainTilesOptions& options, const QueryLimits& limits);
  [[nodiscard]] TilePyramid made_pyramid(const Terrain& terrain, std::shared_ptr<const Globe> globe,
                                         const TerrainTilesOptions& options,
                                         const QueryLimits& limits) const;

  double extent_ = 0.0;  ///< Extent of the terrain, metres.
  double first_error_ = 0.0;
  TilePyramid pyramid_;
};

}  // namespace ptin::tools
