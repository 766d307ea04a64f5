// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory a build takes unasked in a process that has limits: not under a sanitizer, whose memory is beyond any.
#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "engine/construct/build_job.h"
#include "engine/construct/build_plan.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/tile/tile_tree.h"
#include "tests/construct/made_raster.h"
#include "tests/support/resource_limit.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;
using test::ResourceLimit;

constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;

TEST(DefaultMemory, IsThreeQuartersOfTheSmallestLimit) {
  const std::uint64_t unlimited = default_memory();  // a cgroup may have a limit already
  EXPECT_LE(unlimited, kGibibyte);
  EXPECT_GT(unlimited, 0U);
  for (const auto resource : {RLIMIT_DATA, RLIMIT_AS}) {
    for (const std::uint64_t mib : {400U, 1000U, 1U << 20}) {
      const ResourceLimit limit(resource, mib * kMiB);
      ASSERT_TRUE(limit.is_set());
      EXPECT_EQ(default_memory(), std::min(unlimited, mib * kMiB / 4 * 3)) << resource;
    }
  }
  const ResourceLimit data(RLIMIT_DATA, 700 * kMiB);
  const ResourceLimit space(RLIMIT_AS, 600 * kMiB);
  EXPECT_EQ(default_memory(), std::min(unlimited, 450 * kMiB));
}

TEST(DefaultMemory, IsWhatAPlanTakesUnlessItIsToldOtherwise) {
  const ScratchFolder folder;
  const TileTree tree(1000, 1000, 256);
  BuildResources resources;
  const ResourceLimit limit(RLIMIT_DATA, 800 * kMiB);
  const auto memory_of = [&] {
    const MemoryPlan memory = plan_memory(resources.memory_bytes, InputKind::kRaster);
    return plan_build(tree, {folder.file("a.ptin"), {}, resources, memory, {}, {}}).memory.limit;
  };
  EXPECT_EQ(memory_of(), default_memory());
  resources.memory_bytes = 5 * kGibibyte;
  EXPECT_EQ(memory_of(), 5 * kGibibyte);
}

}  // namespace
}  // namespace ptin
