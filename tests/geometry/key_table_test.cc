// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/key_table.h"

#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

RC_GTEST_PROP(KeyTable, AgreesWithAMap, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  KeyTable table;
  std::map<VertexKey, std::uint32_t> map;
  const std::uint64_t side = std::uint64_t{1} << (1 + random() % 10);
  for (int step = 0; step < 500; ++step) {
    const GridPoint p{static_cast<int>(random() % side), static_cast<int>(random() % side)};
    table.reserve(map.size() + 1);
    const bool added = map.emplace(key_of(p), static_cast<std::uint32_t>(step)).second;
    RC_ASSERT(table.insert(key_of(p), static_cast<std::uint32_t>(step)) == added);
    const GridPoint q{static_cast<int>(random() % side), static_cast<int>(random() % side)};
    const auto found = map.find(key_of(q));
    RC_ASSERT(table.find(key_of(q)) == (found == map.end() ? KeyTable::kAbsent : found->second));
    RC_ASSERT(table.size() == map.size());
  }
}

TEST(KeyTable, FindsEveryKeyOfFullLatticesOfAnySpacing) {
  for (const int spacing : {1, 2, 3, 64, 1024, 4096}) {
    KeyTable table(250 * 250);
    for (int y = 0; y < 250; ++y) {
      for (int x = 0; x < 250; ++x) {
        ASSERT_TRUE(table.insert(key_of({x * spacing, y * spacing}),
                                 static_cast<std::uint32_t>(y * 250 + x)));
      }
    }
    for (int y = 0; y < 250; ++y) {
      for (int x = 0; x < 250; ++x) {
        ASSERT_EQ(table.find(key_of({x * spacing, y * spacing})),
                  static_cast<std::uint32_t>(y * 250 + x));
      }
    }
    EXPECT_EQ(table.find(key_of({1 + 250 * spacing, 0})), KeyTable::kAbsent);
  }
}

}  // namespace
}  // namespace ptin
