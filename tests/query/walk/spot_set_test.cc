// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes that hold spots, against a look at each spot.
#include "engine/query/walk/spot_set.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

/// On grid positions, on the lines between them, and anywhere; in a rectangle that may be a line.
std::vector<Spot> random_spots(std::mt19937_64& random) {
  const auto one_of = [&](std::initializer_list<int> c) { return c.begin()[random() % c.size()]; };
  const std::int64_t wide = one_of({0, 1, 40, 3000});
  const std::int64_t high = one_of({0, 1, 40, 3000});
  const auto along = [&](std::int64_t length) {
    const auto whole = static_cast<std::int64_t>(random() % static_cast<unsigned>(length + 1));
    const auto part = whole < length && random() % 2 == 0
                          ? static_cast<std::int64_t>(random() % (1U << kSpotBits))
                          : 0;
    return ((7 + whole) << kSpotBits) + part;
  };
  std::vector<Spot> spots(static_cast<std::size_t>(one_of({1, 2, 10, 700})));
  std::generate(spots.begin(), spots.end(), [&] { return Spot{along(wide), along(high)}; });
  return spots;
}

RC_GTEST_PROP(SpotSet, AnswersAsALookAtEachSpot, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::vector<Spot> spots = random_spots(random);
  const SpotSet set(spots, -1.0);
  for (int asked = 0; asked < 200; ++asked) {
    const GridBox reach = set.reach();
    const auto from = [&](std::int32_t low, std::int32_t high) {
      return low - 2 + static_cast<std::int32_t>(random() % static_cast<unsigned>(high - low + 4));
    };
    const std::int32_t side = 1 + static_cast<std::int32_t>(random() % (asked % 2 == 0 ? 3 : 60));
    const GridPoint low{from(reach.min_x, reach.max_x), from(reach.min_y, reach.max_y)};
    const GridBox box{low.x, low.y, low.x + side, low.y + 1 + side / 2};
    std::vector<std::size_t> expected, visited;
    for (std::size_t i = 0; i < spots.size(); ++i) {
      if (contains(box, spots[i])) expected.push_back(i);
    }
    set.for_each_in(box, [&](std::size_t i) { visited.push_back(i); });
    if (!set.is_single()) {  // which visits a spot near the box too
      std::sort(visited.begin(), visited.end());
      RC_ASSERT(visited == expected);
    }
    RC_ASSERT(set.holds_spot(box) == !expected.empty());
    RC_ASSERT(set.may_hold_spot(box) || expected.empty());
  }
}

TEST(SpotSet, RefusesNearlyAllSmallBoxesWithoutASpot) {
  std::mt19937_64 random(1);
  std::vector<Spot> spots(1000);
  std::generate(spots.begin(), spots.end(), [&] {
    const auto at = [&] { return static_cast<std::int64_t>(random() % (100U << kSpotBits)); };
    return Spot{at(), at()};
  });
  const SpotSet set(spots, -1.0);
  int empty = 0;
  int refused = 0;
  for (std::int32_t y = 0; y < 99; ++y) {
    for (std::int32_t x = 0; x < 99; ++x) {
      const GridBox box{x, y, x + 1, y + 1};
      empty += !set.holds_spot(box);
      refused += !set.may_hold_spot(box);
    }
  }
  EXPECT_GT(empty, 8000);
  EXPECT_EQ(refused, empty);
}

}  // namespace
}  // namespace ptin
