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

/// What one worker does in one go: a tile of level 1 with its leaves; where the root is a leaf,
/// that one.
struct Batch {
  TileId top;
  std::vector<TileId> leaves;
  std::vector<TileId> ancestors;  ///< Above `top`, the root first.
  std::vector<TileId> closed;     ///< Those of which this is the last batch, the lowest first.
};

/// Batches, depth-first.
class BatchOrder {
 public:
  explicit BatchOrder(const TileTree& tree);

  [[nodiscard]] const std::vector<Batch>& batches() const noexcept { return batches_; }
  /// Place of `child` among the children of its parent.
  [[nodiscard]] static std::size_t place_in_parent(const TileTree& tree, const TileId& child);
  /// Samples of the largest leaf of a batch: what its work is estimated by.
  [[nodiscard]] static std::uint64_t largest_leaf(const TileTree& tree, const Batch& batch);
  [[nodiscard]] static TileId parent_of(const TileId& id) noexcept {
    return {id.level + 1, id.x / 2, id.y / 2};
  }

 private:
  void visit(const TileTree& tree, const TileId& id, std::vector<TileId>& path);

  std::vector<Batch> batches_;
};

}  // namespace ptin
