// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/scan_triangle.h"

#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/geometry/orient.h"

namespace ptin::tools {
namespace {

TEST(ScanTriangle, VisitsExactlyTheGridPointsOfTheClosedTriangle) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> coordinate(0, 12);
  const GridBox box{1, 2, 10, 11};
  for (int i = 0; i < 2000; ++i) {
    std::array<GridPoint, 3> t{};
    do {
      for (GridPoint& p : t) p = {coordinate(random), coordinate(random)};
    } while (orient(t[0], t[1], t[2]) <= 0);
    std::set<std::array<std::int32_t, 2>> visited;
    scan_triangle(t, box, [&](std::int32_t x, std::int32_t y) {
      EXPECT_TRUE(visited.insert({x, y}).second);
    });
    const auto lines = edge_lines(t);
    for (std::int32_t y = 0; y <= 12; ++y) {
      for (std::int32_t x = 0; x <= 12; ++x) {
        const GridPoint p{x, y};
        const bool inside =
            orient(t[0], t[1], p) >= 0 && orient(t[1], t[2], p) >= 0 && orient(t[2], t[0], p) >= 0;
        EXPECT_EQ(visited.contains({x, y}), inside && contains(box, p));
        EXPECT_EQ(weights_at(lines, p).in_closed(), inside);
        EXPECT_EQ(weights_at(lines, p).w[0], orient(t[1], t[2], p));
      }
    }
  }
}

TEST(ScanTriangle, HoldsAtTheLimitsOfTheGrid) {
  const std::array<GridPoint, 3> t{GridPoint{0, 0}, {kGridMax, 0}, {kGridMax, kGridMax}};
  const GridBox box{kGridMax - 2, kGridMax - 3, kGridMax, kGridMax};
  int visited = 0;
  scan_triangle(t, box, [&](std::int32_t, std::int32_t) { ++visited; });
  EXPECT_EQ(visited, 3 + 3 + 2 + 1);
}

}  // namespace
}  // namespace ptin::tools
