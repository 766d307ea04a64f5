// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/batch_order.h"

#include <algorithm>

namespace ptin {

std::vector<TileId> ancestors_of(const TileTree& tree, const TileId& id) {
  std::vector<TileId> above;
  for (TileId at = id; at != tree.root();) {
    at = parent_of(at);
    above.push_back(at);
  }
  std::reverse(above.begin(), above.end());
  return above;
}

std::vector<TileId> leaves_of_batch(const TileTree& tree, const TileId& top) {
  return top.level == 0 ? std::vector<TileId>{top} : tree.children(top);
}

std::uint64_t largest_leaf(const TileTree& tree, const TileId& top) {
  std::uint64_t samples = 0;
  for (const TileId& leaf : leaves_of_batch(tree, top)) {
    samples = std::max(samples, tree.window(leaf).samples());
  }
  return samples;
}

BatchOrder::BatchOrder(const TileTree& tree) {
  visit(tree, tree.root());
  output_.insert(output_.begin(), batches_.begin(), batches_.end());
  for (std::size_t i = 0; i < output_.size(); ++i) {
    places_.emplace(output_[i], i);
  }
}

/// Collects the tops of batches, and the tiles above them in output_.
void BatchOrder::visit(const TileTree& tree, const TileId& id) {
  if (id.level <= 1) {
    batches_.push_back(id);
    return;
  }
  const std::size_t first = batches_.size();
  for (const TileId& child : tree.children(id)) {
    visit(tree, child);
  }
  output_.push_back(id);
  batches_of_.emplace_back(first, batches_.size());
}

std::vector<TileId> BatchOrder::above_within(std::size_t begin, std::size_t end) const {
  std::vector<TileId> tiles;
  for (std::size_t i = 0; i < batches_of_.size(); ++i) {
    if (begin <= batches_of_[i].first && batches_of_[i].second <= end) {
      tiles.push_back(output_[batches_.size() + i]);
    }
  }
  std::stable_sort(tiles.begin(), tiles.end(),
                   [](const TileId& a, const TileId& b) { return a.level < b.level; });
  return tiles;
}

}  // namespace ptin
