// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vertex keys are sorted in one reservation, which is seen where operator new may be replaced: not under sanitizers.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "storage/unique_keys.h"
#include "tests/support/replaced_new.h"

namespace {

std::atomic<std::int64_t> key_allocations{0};

bool counts_key_allocations() {
  key_allocations.fetch_add(1, std::memory_order_relaxed);
  return false;
}

}  // namespace

namespace ptin {
namespace {

// Memory that grows is held twice while it moves.
TEST(UniqueKeys, ReservesItsPartOnce) {
  std::vector<GridPoint> points;
  for (std::uint32_t i = 0; i < 300'000; ++i) {
    points.push_back({static_cast<int>(i * 131071U % (1U << 29)), static_cast<int>(i % 7919U)});
  }
  const test::AskedAllocations counting(counts_key_allocations);
  for (const std::uint64_t memory : {1U << 10U, 1U << 20U, 3U << 20U}) {
    const std::int64_t before = key_allocations;
    UniqueKeys keys({0, 0, 1 << 29, 1 << 29}, points.size(), memory, 100);
    EXPECT_EQ(key_allocations - before, 1);
    for (std::uint64_t pass = 0; pass < std::min<std::uint64_t>(keys.passes(), 8); ++pass) {
      keys.begin(pass);
      for (const GridPoint p : points) {
        keys.add(p);
      }
      keys.end();
    }
    EXPECT_EQ(key_allocations - before, 1) << memory << " bytes";
  }
}

}  // namespace
}  // namespace ptin
