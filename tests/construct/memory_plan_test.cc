// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory a build takes unasked, how it shares it out, and what it does when it, or the
// disk, is short.
#include "engine/construct/memory_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <gdal.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/build_job.h"
#include "engine/construct/build_plan.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/told_build.h"
#include "tests/support/resource_limit.h"

namespace ptin {
namespace {

namespace fs = std::filesystem;
using oracle::ScratchFolder;

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

RC_GTEST_PROP(ShareMemory, NeverGivesMoreThanThereIs, ()) {
  const std::uint64_t memory = *rc::gen::inRange<std::uint64_t>(1, 16 * kGiB);
  const std::uint64_t present = *rc::gen::inRange<std::uint64_t>(0, kGiB);
  const int threads = *rc::gen::inRange(1, 64);
  const InputKind kind = *rc::gen::element(InputKind::kRaster, InputKind::kPoints, InputKind::kTin);
  const MemoryPlan plan = plan_memory(memory, kind);
  const std::uint64_t tiles = plan.for_tiles(present, threads);
  RC_ASSERT(plan.limit == memory);
  RC_ASSERT(plan.gdal_cache >= 8 * kMiB);
  RC_ASSERT(plan.gdal_cache <= 64 * kMiB);
  RC_ASSERT(plan.gdal_cache <= std::max(memory / 16, 8 * kMiB));
  RC_ASSERT(plan.sorting <= std::max(memory / 2, kMiB));
  RC_ASSERT((plan.sorting == 0) == (kind == InputKind::kRaster));
  if (tiles > 0) {
    const std::uint64_t buffers = static_cast<std::uint64_t>(threads) * 4 * kMiB;
    RC_ASSERT(tiles + plan.gdal_cache + present + buffers <= memory);
  }
  RC_ASSERT(plan.for_tiles(present, threads + 1) <= tiles);
  RC_ASSERT(plan.for_tiles(present + kMiB, threads) <= tiles);
  RC_ASSERT(plan_memory(memory + kMiB, kind).for_tiles(present, threads) >= tiles);
}

TEST(ShareMemory, GivesGdalASixteenthWithinBounds) {
  const auto cache = [](std::uint64_t memory) {
    return plan_memory(memory, InputKind::kRaster).gdal_cache;
  };
  EXPECT_EQ(cache(64 * kMiB), 8 * kMiB);
  EXPECT_EQ(cache(512 * kMiB), 32 * kMiB);
  EXPECT_EQ(cache(64 * kGiB), 64 * kMiB);
}

TEST(GdalCacheLimit, IsThatOfABuildForAsLongAsItRuns) {
  const std::int64_t before = GDALGetCacheMax64();
  {
    const GdalCacheLimit outer(33 * kMiB);
    {
      const GdalCacheLimit inner(9 * kMiB);
      EXPECT_EQ(GDALGetCacheMax64(), 9 * static_cast<std::int64_t>(kMiB));
    }
    EXPECT_EQ(GDALGetCacheMax64(), 33 * static_cast<std::int64_t>(kMiB));
  }
  EXPECT_EQ(GDALGetCacheMax64(), before);

  oracle::RasterFile file;
  file.value = [](int x, int y) { return x * y % 7; };
  const oracle::WrittenRaster raster(file);
  const ScratchFolder folder;
  BuildResources resources;
  resources.memory_bytes = 800 * kMiB;  // a sanitizer holds half of that
  std::uint64_t planned = 0;
  std::int64_t seen = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_plan = [&](const BuildPlan& plan) {
    planned = plan.memory.gdal_cache;
    seen = GDALGetCacheMax64();
  };
  build({raster.path()}, folder.file("a.ptin"), {}, resources);
  EXPECT_EQ(planned, 50 * kMiB);
  EXPECT_EQ(seen, static_cast<std::int64_t>(planned));
  EXPECT_EQ(GDALGetCacheMax64(), before);
}

/// Leaves of points and TINs take more in their replay than those of rasters, and the workers must
/// be admitted by what the plan says of them.
TEST(HierarchyOptions, AdmitWorkersByWhatThePlanSaysOfTheSource) {
  const ScratchFolder folder;
  const std::vector<std::string> inputs;
  const std::string output = folder.file("a.ptin");
  const BuildOptions options;
  const BuildResources resources;
  const TileTree tree(1000, 1000, 256);
  std::uint64_t of_raster = 0;
  for (const InputKind kind : {InputKind::kRaster, InputKind::kPoints, InputKind::kTin}) {
    const build_internal::Job job{inputs, output, options, resources, plan_memory(kGiB, kind), {}};
    const BuildPlan plan = plan_build(tree, job.plan_request({}));
    const build_internal::TiledSource source{{}, {}, tree, {}};
    const HierarchyOptions built = hierarchy_options(job, source, plan);
    const std::uint64_t of_leaf = built.memory.tile_bytes.of_replay(tree.side() * tree.side());
    EXPECT_EQ(of_leaf, plan.tile_bytes.of_replay(tree.side() * tree.side()));
    EXPECT_EQ(built.memory.for_tiles, plan.memory_for_tiles);
    if (kind == InputKind::kRaster) {
      of_raster = of_leaf;
    } else {
      EXPECT_GT(of_leaf, of_raster);
    }
  }
}

/// Plans for a terrain that is not there.
class PlanBuild : public ::testing::Test {
 protected:
  PlanBuild() {
    resources_.threads = 8;
    resources_.memory_bytes = 64 * kGiB;
  }
  BuildPlan plan(std::int64_t side, std::int64_t tile, const SourceDisk& source = {}) {
    const MemoryPlan memory = plan_memory(resources_.memory_bytes, InputKind::kRaster);
    return plan_build(TileTree(side, side, tile),
                      {output_, options_, resources_, memory, tile_bytes_, source});
  }
  std::optional<Error> refusal(std::int64_t side, std::int64_t tile,
                               const SourceDisk& source = {}) {
    try {
      static_cast<void>(plan(side, tile, source));
    } catch (const Error& e) {
      return e;
    }
    return std::nullopt;
  }
  ScratchFolder folder_;
  std::string output_ = folder_.file("a.ptin");
  BuildOptions options_;
  BuildResources resources_;
  TileBytes tile_bytes_;
};

TEST_F(PlanBuild, UsesFewerThreadsWhereMemoryIsShort) {
  constexpr std::int64_t kSide = 2049, kTile = 256;
  EXPECT_EQ(plan(kSide, kTile).threads, 8);
  EXPECT_EQ(plan(kSide, kTile).threads_wanted, 8);
  int before = 8;
  bool was_between = false;
  // From plenty down to where nothing fits.
  for (std::uint64_t mib = 2048; !refusal(kSide, kTile); mib -= 64) {
    ASSERT_GT(mib, 64U) << "never refused";
    resources_.memory_bytes = mib * kMiB;
    if (refusal(kSide, kTile)) {
      break;
    }
    const BuildPlan p = plan(kSide, kTile);
    EXPECT_EQ(p.threads_wanted, 8);
    EXPECT_LE(p.threads, before) << mib;
    EXPECT_GE(p.threads, 1) << mib;
    was_between = was_between || (p.threads > 1 && p.threads < 8);
    before = p.threads;
    EXPECT_LE(p.memory_expected, p.memory.limit) << mib;
    EXPECT_EQ(p.memory.limit, mib * kMiB);
    // Each thread has room for the largest leaf: one of half as much again along a side.
    const std::uint64_t leaf = kTile * kTile;
    EXPECT_GE(p.memory_for_tiles,
              tile_bytes_.of_batch(leaf) * static_cast<std::uint64_t>(p.threads))
        << mib;
  }
  EXPECT_EQ(before, 1);
  EXPECT_TRUE(was_between);
}

/// The number behind a word of a message.
std::uint64_t number_after(const std::string& message, const std::string& word) {
  const std::size_t at = message.rfind(word);
  return at == std::string::npos ? 0 : std::stoull(message.substr(at + word.size()));
}

TEST_F(PlanBuild, NamesTheMemoryAndTheTileThatWouldDo) {
  constexpr std::int64_t kSide = 8193, kTile = 1024;
  const std::uint64_t given = anonymous_bytes_now() / kMiB + 256;
  resources_.memory_bytes = given * kMiB;
  const auto refused = refusal(kSide, kTile);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ErrorCode::resource_exhausted);
  const std::uint64_t mib = number_after(refused->message(), "--memory ");
  const std::uint64_t tile = number_after(refused->message(), "--tile ");
  ASSERT_GT(mib, given) << refused->message();
  ASSERT_GT(tile, 32U) << refused->message();
  ASSERT_LT(tile, 1024U) << refused->message();
  EXPECT_FALSE(refusal(kSide, static_cast<std::int64_t>(tile))) << refused->message();
  // A little more than the process had when the sentence was made.
  resources_.memory_bytes = (mib + 16) * kMiB;
  EXPECT_FALSE(refusal(kSide, kTile)) << refused->message();
  EXPECT_EQ(plan(kSide, kTile).threads, 1);
}

TEST_F(PlanBuild, SaysWhatTheDiskHas) {
  const BuildPlan p = plan(1000, 256);
  const auto space = fs::space(folder_.path());
  const auto near = [](std::uint64_t a, std::uint64_t b) {
    return std::abs(static_cast<double>(a) - static_cast<double>(b)) < 0.5 * static_cast<double>(b);
  };
  EXPECT_TRUE(near(p.output_free, space.available)) << p.output_free << " " << space.available;
  EXPECT_EQ(p.output_free, p.temporary_free);
  EXPECT_TRUE(p.same_disk);
  EXPECT_GE(p.output_bytes, p.vertices * 46);
  EXPECT_GE(p.temporary_bytes, p.vertices * 50);
}

/// 2^46 vertices: no disk has room for what they take.
constexpr std::int64_t kHuge = std::int64_t{1} << 23;

TEST_F(PlanBuild, RefusesWhatTheDiskCannotHold) {
  resources_.memory_bytes = 1024 * kGiB;
  const auto refused = refusal(kHuge, 256);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ErrorCode::resource_exhausted);
  EXPECT_EQ(refused->context(), output_);
  for (const std::string& word :
       {std::string("are free"), std::string("--tmp"), folder_.path().string()}) {
    EXPECT_NE(refused->message().find(word), std::string::npos) << refused->message();
  }
}

TEST_F(PlanBuild, RefusesNothingThatMayBeLess) {
  resources_.memory_bytes = 1024 * kGiB;
  SourceDisk source;
  source.tiles_of_vertex = 0.0;
  EXPECT_TRUE(refusal(kHuge, 256, source)) << "the output alone is too large";
  options_.max_error = 1.0;
  EXPECT_FALSE(refusal(kHuge, 256, source)) << "most may be left out";
  source.while_reading = std::uint64_t{1} << 60;
  EXPECT_TRUE(refusal(kHuge, 256, source)) << "what is needed for reading";
  source.may_be_less = true;
  EXPECT_FALSE(refusal(kHuge, 256, source)) << "most may be on the disk already";
  source.may_be_less = false;
  resources_.unfinished = Unfinished::kResume;
  EXPECT_TRUE(refusal(kHuge, 256, source)) << "nothing is there to be resumed";
  fs::create_directory(Workspace::folder_of(output_));
  EXPECT_FALSE(refusal(kHuge, 256, source)) << "an interrupted build may have written it";
}

TEST_F(PlanBuild, CountsTwoDisksApart) {
  const ScratchFolder elsewhere(ScratchFolder::Size::kSmall);
  resources_.tmp = elsewhere.path().string();
  if (plan(1000, 256).same_disk) {
    GTEST_SKIP() << "needs a second file system in memory";
  }
  resources_.memory_bytes = 1024 * kGiB;
  options_.max_error = 1.0;  // the output itself is no reason
  const auto refused = refusal(kHuge, 256);
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->message().find("in " + resources_.tmp), std::string::npos)
      << refused->message();
  options_.max_error = 0.0;
  SourceDisk source;
  source.tiles_of_vertex = 0.0;
  const auto output = refusal(kHuge, 256, source);
  ASSERT_TRUE(output);
  EXPECT_NE(output->message().find("in " + folder_.path().string()), std::string::npos)
      << output->message();
}

TEST(BuildOnASmallDisk, IsRefusedBeforeItBegins) {
  const ScratchFolder folder;
  const test::SmallDisk disk(folder.file("disk"), 2);
  if (!disk.is_mounted()) {
    GTEST_SKIP() << test::SmallDisk::kNeeded;
  }
  oracle::RasterFile file;
  file.columns = file.rows = 300;
  file.value = [](int x, int y) { return (x * 31 + y * 17) % 23; };
  const oracle::WrittenRaster raster(file);
  try {
    build({raster.path()}, disk.path() + "/a.ptin", {}, {});
    FAIL() << "90 000 vertices in 2 MiB";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("are free"), std::string::npos) << e.message();
  }
  EXPECT_TRUE(fs::is_empty(disk.path()));
}

}  // namespace
}  // namespace ptin
