// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/tile_tree.h"

#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

/// Leaves below a tile, in the order of the children.
void collect_leaves(const TileTree& tree, const TileId& id, std::vector<TileId>& leaves) {
  if (id.level == 0) {
    leaves.push_back(id);
  }
  for (const TileId& child : tree.children(id)) {
    collect_leaves(tree, child, leaves);
  }
}

TEST(TileTree, OneTileHoldsASmallRaster) {
  const TileTree tree(100, 50, 512);
  EXPECT_EQ(tree.levels(), 1);
  EXPECT_EQ(tree.leaves(), 1U);
  EXPECT_EQ(tree.window(tree.root()), (SampleRange{0, 0, 100, 50}));
  EXPECT_FALSE(tree.on_seam(tree.root(), 0, 0));
  EXPECT_FALSE(tree.on_seam(tree.root(), 99, 20));
}

TEST(TileTree, NeighboursShareTheRowBetweenThem) {
  const TileTree tree(21, 11, 10);
  const std::vector<TileId> leaves = tree.children(tree.root());
  ASSERT_EQ(leaves.size(), 2U);
  EXPECT_EQ(tree.window(leaves[0]), (SampleRange{0, 0, 11, 11}));
  EXPECT_EQ(tree.window(leaves[1]), (SampleRange{10, 0, 11, 11}));
  EXPECT_TRUE(tree.on_seam(leaves[0], 10, 0));
  EXPECT_TRUE(tree.on_seam(leaves[1], 10, 10));
  EXPECT_FALSE(tree.on_seam(leaves[0], 0, 5));
  EXPECT_FALSE(tree.on_seam(leaves[1], 20, 5));
  EXPECT_FALSE(tree.on_seam(tree.root(), 10, 5));
}

RC_GTEST_PROP(TileTree, LeavesCoverEveryCellOnce,
              (std::uint8_t w, std::uint8_t h, std::uint8_t s)) {
  const std::int64_t width = 2 + w % 90;
  const std::int64_t height = 2 + h % 90;
  const TileTree tree(width, height, 2 + s % 40);
  std::vector<TileId> leaves;
  collect_leaves(tree, tree.root(), leaves);
  RC_ASSERT(leaves.size() == tree.leaves());
  std::set<std::pair<std::int64_t, std::int64_t>> cells;
  for (const TileId& leaf : leaves) {
    const SampleRange r = tree.window(leaf);
    RC_ASSERT(r.width >= 2 && r.height >= 2);
    for (std::int64_t y = r.y0; y + 1 < r.y0 + r.height; ++y) {
      for (std::int64_t x = r.x0; x + 1 < r.x0 + r.width; ++x) {
        RC_ASSERT(cells.emplace(x, y).second);
      }
    }
  }
  RC_ASSERT(cells.size() == static_cast<std::size_t>((width - 1) * (height - 1)));
}

TEST(TileTree, TheDefaultSideDependsOnTheRasterAlone) {
  EXPECT_EQ(TileTree::default_side(350, 300), 350);
  EXPECT_EQ(TileTree::default_side(1201, 1201), 256);
  EXPECT_EQ(TileTree::default_side(16385, 16385), 256);
  EXPECT_EQ(TileTree::default_side(32769, 16385), 384);
  EXPECT_EQ(TileTree::default_side(100000, 100000), 640);
}

}  // namespace
}  // namespace ptin
