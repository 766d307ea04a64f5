// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tile pushes up to its parent, and how four siblings join.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/construct/tile/tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// What is left of a tile: its alive vertices and triangles, all their samples or carried ones, and
/// of its records those that a triangle carries. The parent takes these records as foreign ones.
struct PushedTile {
  Tile tile;
  /// For each of tile.records: its index in `records` of the tile that was cut down.
  std::vector<std::uint32_t> exported;
  /// What is not pushed: all records of the tile that was cut down, and the stars of its own.
  std::vector<VertexSplit> records;
  RecordStars stars;
};

/// The samples that a parent is given to measure by.
enum class PushedSamples {
  kAll,      ///< Every sample: the parent certifies its records itself.
  kCarried,  ///< A few of each triangle (construct/collapse/carried_samples.h): tightening certifies.
};

/// Cuts a finished tile down to what is pushed. Vertices and triangles keep their order.
/// Cost: linear. The argument is used up.
[[nodiscard]] PushedTile push_up(Tile&& tile, PushedSamples samples);

/// Joins siblings along their seams. Vertices on a common seam become one, and triangles are linked
/// across it; vertices on a seam of the parent are locked, all others are not. Records stand one
/// after the other, in the order of the parts.
/// @param parts  In the order of TileTree::children(). Used up.
/// Cost: linear, and sorting of the vertices.
[[nodiscard]] Tile join_tiles(std::vector<Tile>&& parts, const TileTree& tree,
                              const TileId& parent);

/// Locks the vertices of a tile that are on its seams, and unlocks all others. Over points and TINs
/// a vertex is on a seam when it has an edge without a triangle beyond that does not lie on the
/// hull.
void lock_seams(Tile& tile, const TileTree& tree, const TileId& id);

}  // namespace ptin
