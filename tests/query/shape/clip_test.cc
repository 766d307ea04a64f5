// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/clip.h"

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/interval.h"
#include "engine/query/shape/bins_along_y.h"

namespace ptin {
namespace {

/// What of a polygon lies where x is at least `at`: corners kept by number, crossings as -1.
std::vector<int> right_of(const std::vector<MapPoint>& polygon, double at) {
  std::vector<int> left;
  clip_convex(
      polygon.size(), [&](std::size_t i) { return polygon[i].x - at; },
      [&](std::size_t i) { left.push_back(static_cast<int>(i)); },
      [&](std::size_t, std::size_t) { left.push_back(-1); });
  return left;
}

TEST(ClipConvex, CrossesEdgesWithAnEndOnEitherSideAlone) {
  const std::vector<MapPoint> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_EQ(right_of(square, 1), (std::vector<int>{-1, 1, 2, -1}));
  EXPECT_EQ(right_of(square, 0), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(right_of(square, 2), (std::vector<int>{1, 2}));
  EXPECT_TRUE(right_of(square, 3).empty());
  const std::vector<MapPoint> triangle{{0, 0}, {1, -1}, {1, 1}};
  EXPECT_EQ(right_of({{0, 0}, {1, 1}, {-1, 1}}, 0), (std::vector<int>{0, 1, -1}));
  EXPECT_EQ(right_of(triangle, 1), (std::vector<int>{1, 2}));
}

TEST(Meet, GivesTheSameBitsFromEitherEndAndAnEndThatLiesOnTheLine) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> anywhere(-1e6, 1e6);
  for (int i = 0; i < 1000; ++i) {
    const double au = anywhere(random), av = anywhere(random);
    const double bu = anywhere(random), bv = anywhere(random);
    const double at = au + 0.3 * (bu - au);
    EXPECT_EQ(meet(au, av, bu, bv, at), meet(bu, bv, au, av, at));
    EXPECT_EQ(meet(au, av, bu, bv, au), av);
    EXPECT_EQ(meet(au, av, bu, bv, bu), bv);
  }
}

TEST(BinsAlongY, FindsAllThingsThatReachAPlaceEachOnce) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> anywhere(-50, 50);
  for (const double tallest : {0.0, 1.0, 40.0}) {
    std::vector<Interval> things;
    for (int i = 0; i < 300; ++i) {
      const double low = anywhere(random);
      things.push_back({low, low + tallest * (anywhere(random) + 50) / 100});
    }
    const BinsAlongY bins(things);
    for (int i = 0; i < 200; ++i) {
      const double low = anywhere(random) * 1.2, high = low + (i % 2 == 0 ? 0.0 : 7.0);
      std::vector<int> seen(things.size()), asked(things.size());
      bins.visit(low, high, [&](std::uint32_t k) { ++seen[k]; });
      EXPECT_FALSE(bins.any(low, high, [&](std::uint32_t k) { return ++asked[k] < 0; }));
      for (std::size_t k = 0; k < things.size(); ++k) {
        EXPECT_LE(seen[k], 1);
        EXPECT_EQ(seen[k] > 0, asked[k] > 0);
        if (meets(things[k], Interval{low, high})) {
          EXPECT_EQ(seen[k], 1);
        }
      }
      for (const std::uint32_t k : bins.at(low)) ++asked[k];
      for (std::size_t k = 0; k < things.size(); ++k) {
        if (contains(things[k], low)) {
          EXPECT_GT(asked[k], 1);
        }
      }
    }
  }
}

TEST(BinsAlongY, HoldsNothing) {
  const BinsAlongY bins;
  bins.visit(0, 1, [](std::uint32_t) { FAIL(); });
  EXPECT_FALSE(bins.any(0, 1, [](std::uint32_t) { return true; }));
  EXPECT_TRUE(bins.at(0).empty());
}

}  // namespace
}  // namespace ptin
