// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tile pushes up to its parent, and how four siblings join.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/construct/tile/tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// What is left of a tile: its alive vertices and triangles, their samples or witnesses, and of its
/// records those that a triangle carries. `tile.records` are foreign to whoever takes it over.
struct PushedTile {
  Tile tile;
  std::vector<std::uint32_t>
      exported;  ///< Of each foreign record: its index in the tile that pushed it.
};

/// What a parent is given to measure by.
enum class PushedSamples {
  kAll,        ///< Every sample: it certifies its records itself.
  kWitnesses,  ///< A few of each triangle (witness.h): tightening certifies them.
};

/// Cuts a finished tile down to what is pushed. Vertices and triangles keep their order.
/// Cost: linear. The argument is used up.
[[nodiscard]] PushedTile push_up(Tile&& tile, PushedSamples samples);

/// Joins siblings along their seams: vertices on them become one, neighbours are linked, and
/// vertices are locked that are still on a seam of the parent. Records stand one after the other,
/// in the order of the parts.
/// @param parts  In the order of TileTree::children().
/// Cost: linear, and sorting of the vertices.
[[nodiscard]] Tile join_tiles(std::vector<Tile>&& parts, const TileTree& tree,
                              const TileId& parent);

/// Locks the vertices of a tile that are on its seams: over points those with an edge that has no
/// triangle beyond and does not lie on the hull.
void lock_seams(Tile& tile, const TileTree& tree, const TileId& id);

}  // namespace ptin
