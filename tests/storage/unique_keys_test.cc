// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vertex keys that come twice: found in any pass, as many as were asked for.
#include "storage/unique_keys.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

/// More positions than the memory has bits: keys are sorted, part by part.
constexpr GridBox kWide{0, 0, 1 << 29, 1 << 29};
constexpr GridBox kSmall{0, 0, 1 << 10, 1 << 10};

GridPoint spread(std::uint32_t i) {
  return {static_cast<int>(i * 131071U % (1U << 29)), static_cast<int>(i % 7919U)};
}

/// All keys of `points` in each pass. @returns how many are known to come twice after each pass
std::vector<std::size_t> run(UniqueKeys& keys, const std::vector<GridPoint>& points) {
  std::vector<std::size_t> found;
  for (std::uint64_t pass = 0; pass < keys.passes(); ++pass) {
    keys.begin(pass);
    for (const GridPoint p : points) {
      keys.add(p);
    }
    keys.end();
    found.push_back(keys.twice().size());
  }
  return found;
}

std::vector<GridPoint> spread_points(std::uint32_t count) {
  std::vector<GridPoint> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    points.push_back(spread(i));
  }
  return points;
}

TEST(UniqueKeys, FindsTheKeyThatComesTwiceInWhateverPassItFalls) {
  const std::vector<GridPoint> once = spread_points(5000);
  std::set<std::size_t> passes_of_twice;
  for (std::size_t i = 0; i < once.size(); i += 250) {
    std::vector<GridPoint> points = once;
    points.push_back(once[i]);
    UniqueKeys keys(kWide, points.size(), 1, 100);
    ASSERT_EQ(keys.passes(), 5U);
    const std::vector<std::size_t> found = run(keys, points);
    EXPECT_EQ(keys.twice(), std::vector<VertexKey>{key_of(once[i])});
    passes_of_twice.insert(static_cast<std::size_t>(
        std::find(found.begin(), found.end(), std::size_t{1}) - found.begin()));
  }
  EXPECT_EQ(passes_of_twice, (std::set<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(UniqueKeys, KeepsAsManyThatComeTwiceAsItWasAskedFor) {
  for (const bool by_bits : {false, true}) {
    std::vector<GridPoint> points;
    for (int copy = 0; copy < 3; ++copy) {
      for (int i = 0; i < 1000; ++i) {
        points.push_back({i, 3 * i % 1000});
      }
    }
    for (const std::size_t most : {1U, 5U, 100U}) {
      UniqueKeys keys(by_bits ? kSmall : kWide, points.size(), by_bits ? 1U << 20U : 1, most);
      EXPECT_EQ(keys.passes() == 1, by_bits);
      run(keys, points);
      EXPECT_EQ(keys.twice().size(), most);
      for (const VertexKey key : keys.twice()) {
        const GridPoint p = point_of(key);
        EXPECT_EQ(p.y, 3 * p.x % 1000);
      }
    }
  }
}

TEST(UniqueKeys, FindsNothingWhereNoKeyComesTwice) {
  const std::vector<GridPoint> points = spread_points(20000);
  for (const std::uint64_t memory : {1U, 1U << 16U, 1U << 20U}) {
    UniqueKeys keys(kWide, points.size(), memory, 100);
    run(keys, points);
    EXPECT_TRUE(keys.twice().empty());
  }
}

TEST(UniqueKeys, TakesAsManyPassesAsItsPartsNeed) {
  EXPECT_EQ(UniqueKeys(kSmall, 1000, 1 << 20, 1).passes(), 1U);
  EXPECT_EQ(UniqueKeys(kWide, 1000, 1 << 20, 1).passes(), 1U);
  // 2^17 keys at once, and a few in each part beyond the equal share.
  EXPECT_EQ(UniqueKeys(kWide, 1'000'000, 1 << 20, 1).passes(), 8U);
  EXPECT_EQ(UniqueKeys(kWide, std::uint64_t{1} << 33, std::uint64_t{1} << 20, 1).passes(), 66561U);
}

}  // namespace
}  // namespace ptin
