// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/point_count.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/point_buckets.h"
#include "engine/error.h"
#include "tests/construct/las_file.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

std::string lines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += std::to_string(1000000 + i % 300) + " " + std::to_string(1000000 + i / 300) + " 7.5\n";
  }
  return text;
}

TEST(PointCount, KnowsShortTextExactlyAndLongTextNearly) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("short.xyz"), lines(4321));
  EXPECT_EQ(count_points({folder.file("short.xyz")}, {}).points, 4321U);
  oracle::write_text(folder.file("long.xyz"), lines(90000));
  const auto points = static_cast<double>(count_points({folder.file("long.xyz")}, {}).points);
  EXPECT_NEAR(points, 90000.0, 90000.0 * 0.02);
}

TEST(PointCount, TakesLasAtItsWordAndKnowsThatClassesMayLeaveSomeOut) {
  const oracle::ScratchFolder folder;
  LasFileMaker las;
  for (int i = 0; i < 100; ++i) {
    las.points.push_back({i, i * i, 1, i % 2 == 0 ? 2 : 6});
  }
  oracle::write_text(folder.file("a.las"), las.bytes());
  const PointCount all = count_points({folder.file("a.las")}, {});
  EXPECT_EQ(all.points, 100U);
  EXPECT_FALSE(all.may_be_less);
  SourceOptions ground;
  ground.points.classes = {2};
  EXPECT_TRUE(count_points({folder.file("a.las")}, ground).may_be_less);
}

/// The plan of a build of points, from their files' headers alone.
BuildPlan planned(const oracle::ScratchFolder& folder, const BuildOptions& options) {
  BuildPlan plan;
  BuildResources resources;
  resources.dry_run = true;
  resources.plan = [&](const BuildPlan& p) { plan = p; };
  build({folder.file("long.xyz")}, folder.file("out.ptin"), options, resources);
  return plan;
}

TEST(PointPlan, CountsWhatSortingTakesOfTheDiskAndLeavesNothingBehind) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("long.xyz"), lines(90000));
  BuildOptions one;
  one.tile = 1000;
  const BuildPlan plan = planned(folder, one);
  EXPECT_TRUE(plan.is_estimate);
  EXPECT_EQ(plan.leaves, 1U);
  EXPECT_GE(plan.temporary_bytes, 43U * 88000U) << "no tiles, but points to be sorted";
  BuildOptions many;
  many.tile = 40;
  const BuildPlan tiled = planned(folder, many);
  EXPECT_GT(tiled.leaves, 1U);
  EXPECT_GE(tiled.temporary_bytes, (16U + 40U) * 88000U) << "buckets stay beside the tiles";
  EXPECT_EQ(folder.names(), std::vector<std::string>{"long.xyz"});
}

}  // namespace
}  // namespace ptin
