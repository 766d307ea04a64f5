// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/apply_order.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

/// Splits of any rank with boxes of any size, many of them small; some far away from the others.
std::vector<PendingSplit> random_splits(std::mt19937_64& random, std::size_t count) {
  std::vector<PendingSplit> splits(count);
  const int side = 1 << (4 + random() % 26);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (PendingSplit& s : splits) {
    const int size = 1 + (side >> (random() % 16));
    const int reach = random() % 10 == 0 ? side : side / 8 + 1;
    const GridPoint low{below(reach), below(reach)};
    s.roi = {low.x, low.y, std::min(low.x + below(size), kGridMax),
             std::min(low.y + below(size), kGridMax)};
    s.u = key_of(low);
    s.rank = static_cast<std::uint16_t>(below(60));
  }
  return splits;
}

RC_GTEST_PROP(ApplyOrder, PutsEverySplitBehindWhatItMayNeed, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto count = static_cast<std::size_t>(random() % 3 == 0 ? 50 : 4000 + random() % 9000);
  const std::vector<PendingSplit> splits = random_splits(random, count);
  const std::vector<std::uint32_t> order = order_of(splits);
  RC_ASSERT(order.size() == count);
  std::vector<std::uint32_t> places(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    places.at(order[k]) = k;
  }
  RC_ASSERT(std::set<std::uint32_t>(order.begin(), order.end()).size() == count);
  for (int i = 0; i < 200'000; ++i) {
    const std::size_t a = random() % count;
    const std::size_t b = random() % count;
    if (splits[a].rank > splits[b].rank && contains(splits[a].roi, splits[b].roi)) {
      RC_ASSERT(places[a] < places[b]);
    }
  }
}

TEST(ApplyOrder, OfFewIsByFallingRankAndKeepsTheOrderOfEqualOnes) {
  std::mt19937_64 random(5);
  const std::vector<PendingSplit> splits = random_splits(random, 3000);
  std::vector<std::uint32_t> expected(splits.size());
  std::iota(expected.begin(), expected.end(), 0U);
  std::stable_sort(expected.begin(), expected.end(),
                   [&](auto a, auto b) { return splits[a].rank > splits[b].rank; });
  EXPECT_EQ(order_of(splits), expected);
}

}  // namespace
}  // namespace ptin
