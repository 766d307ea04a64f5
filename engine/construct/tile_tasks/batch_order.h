// SPDX-License-Identifier: GPL-3.0-or-later
//
// In which order the tiles of a tree are built and their segments written: a function of the tree
// alone, whatever the workers do.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// The tile above. REQUIRES: `id` is not the root.
[[nodiscard]] inline TileId parent_of(const TileId& id) noexcept {
  return {id.level + 1, id.x / 2, id.y / 2};
}
/// The tiles above `id`, the root first.
[[nodiscard]] std::vector<TileId> ancestors_of(const TileTree& tree, const TileId& id);

// A batch is a tile of level 1 with its leaves, known by the name of that tile, its top. Where the
// root is a leaf, the only batch is that leaf.

/// The leaves of the batch with this top, in the order of TileTree::children().
[[nodiscard]] std::vector<TileId> leaves_of_batch(const TileTree& tree, const TileId& top);
/// Samples of the largest leaf of a batch: the memory of its work is estimated from them
/// (TileBytes).
[[nodiscard]] std::uint64_t largest_leaf(const TileTree& tree, const TileId& top);

/// All batches of a tree, depth-first, and where segments lie in the output: those of the batches in
/// that order, then those of the tiles above, each behind the last batch inside of it, the lowest
/// first. Memory: two names a batch, and an entry of a map.
class BatchOrder {
 public:
  explicit BatchOrder(const TileTree& tree);

  /// The tops.
  [[nodiscard]] const std::vector<TileId>& batches() const noexcept { return batches_; }
  /// The tops, then the tiles above in the order in which the batches end them.
  [[nodiscard]] const std::vector<TileId>& output() const noexcept { return output_; }
  /// The place of a top, or of a tile above, in output().
  [[nodiscard]] std::size_t place_of(const TileId& id) const { return places_.at(id); }
  /// The tiles above the batches of which all batches have a place in [begin, end), the lowest first.
  [[nodiscard]] std::vector<TileId> above_within(std::size_t begin, std::size_t end) const;

 private:
  void visit(const TileTree& tree, const TileId& id);

  std::vector<TileId> batches_, output_;
  std::map<TileId, std::size_t> places_;
  std::vector<std::pair<std::size_t, std::size_t>> batches_of_;  ///< Batches of each tile above.
};

}  // namespace ptin
