// SPDX-License-Identifier: GPL-3.0-or-later
//
// In which order the tiles of a tree are built and their segments written: a function of the tree
// alone, whatever the threads do.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// The unit of work of one worker: a tile of level 1 with its leaves. Where the root is a leaf, the
/// only batch is that leaf.
struct Batch {
  TileId top;                     ///< The tile of level 1, or the root that is a leaf.
  std::vector<TileId> leaves;     ///< In the order of TileTree::children().
  std::vector<TileId> ancestors;  ///< The tiles above `top`, the root first.
  std::vector<TileId> closed;     ///< The ancestors with no later batch, the lowest first.
};

/// All batches of a tree, depth-first.
class BatchOrder {
 public:
  explicit BatchOrder(const TileTree& tree);

  [[nodiscard]] const std::vector<Batch>& batches() const noexcept { return batches_; }
  /// Place of `child` among the children of its parent. REQUIRES: it is not the root.
  [[nodiscard]] static std::size_t place_in_parent(const TileTree& tree, const TileId& child);
  /// Samples of the largest leaf of a batch: the memory of its work is estimated from them
  /// (TileBytes).
  [[nodiscard]] static std::uint64_t largest_leaf(const TileTree& tree, const Batch& batch);
  [[nodiscard]] static TileId parent_of(const TileId& id) noexcept {
    return {id.level + 1, id.x / 2, id.y / 2};
  }

 private:
  void visit(const TileTree& tree, const TileId& id, std::vector<TileId>& path);

  std::vector<Batch> batches_;
};

}  // namespace ptin
