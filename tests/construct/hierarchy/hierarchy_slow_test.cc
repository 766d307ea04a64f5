// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains over many tiles: every promise, and chains of records that do not grow with them.
#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/construct/hierarchy/tiled_terrain.h"

namespace ptin::test {
namespace {

TEST(Hierarchy, KeepsEveryPromiseOverSixBySixTiles) {
  for (const bool voids : {false, true}) {
    EXPECT_EQ(check_tiled(hills(97, voids ? 2 : 1, voids), 16), "");
  }
}

int highest_rank(const Built& b) {
  int highest = 0;
  for (const VertexSplit& r : b.records) {
    highest = std::max(highest, int{r.rank});
  }
  return highest;
}

TEST(Hierarchy, ChainsDoNotGrowWithTheNumberOfTiles) {
  const oracle::TestTerrain terrain = hills(kSamplesAlong, 4, false);
  const int whole = highest_rank(build_tiled(terrain, 1000));
  // 47 as one tile; 48, 47 and 53 in 4, 16 and 64 tiles.
  for (const std::int64_t side : {80, 40, 20}) {
    EXPECT_LE(highest_rank(build_tiled(terrain, side)), whole + whole / 5) << "tiles of " << side;
  }
}

}  // namespace
}  // namespace ptin::test
