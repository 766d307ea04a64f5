// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/batch_order.h"

#include <algorithm>

namespace ptin {

BatchOrder::BatchOrder(const TileTree& tree) {
  std::vector<TileId> path;
  visit(tree, tree.root(), path);
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    const std::vector<TileId>& own = batches_[i].ancestors;
    const std::vector<TileId> next =
        i + 1 < batches_.size() ? batches_[i + 1].ancestors : std::vector<TileId>{};
    for (std::size_t k = own.size(); k-- > 0;) {
      if (std::find(next.begin(), next.end(), own[k]) == next.end()) {
        batches_[i].closed.push_back(own[k]);
      }
    }
  }
}

void BatchOrder::visit(const TileTree& tree, const TileId& id, std::vector<TileId>& path) {
  if (id.level <= 1) {
    const std::vector<TileId> children = tree.children(id);
    batches_.push_back({id, children.empty() ? std::vector<TileId>{id} : children, path, {}});
    return;
  }
  path.push_back(id);
  for (const TileId& child : tree.children(id)) {
    visit(tree, child, path);
  }
  path.pop_back();
}

std::uint64_t BatchOrder::largest_leaf(const TileTree& tree, const Batch& batch) {
  std::uint64_t samples = 0;
  for (const TileId& leaf : batch.leaves) {
    samples = std::max(samples, tree.window(leaf).samples());
  }
  return samples;
}

std::size_t BatchOrder::place_in_parent(const TileTree& tree, const TileId& child) {
  const std::vector<TileId> siblings = tree.children(parent_of(child));
  return static_cast<std::size_t>(std::find(siblings.begin(), siblings.end(), child) -
                                  siblings.begin());
}

}  // namespace ptin
