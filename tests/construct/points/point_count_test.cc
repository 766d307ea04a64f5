// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_count.h"

#include <array>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/told_build.h"
#include "tests/support/las_file.h"

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
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_plan = [&](const BuildPlan& p) { plan = p; };
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

/// A grid of so many vertices a side.
std::string mesh(const std::string& extension, int side) {
  std::string vertices, triangles;
  const int count = side * side;
  for (int i = 0; i < count; ++i) {
    const std::string at = std::to_string(500000 + i % side) + ".25 " +
                           std::to_string(4000000 + i / side) + ".75 " + std::to_string(i % 97);
    vertices += extension == ".obj"   ? "v " + at + "\n"
                : extension == ".2dm" ? "ND " + std::to_string(i + 1) + " " + at + "\n"
                                      : at + "\n";
  }
  int number = 0;
  for (int i = 0; i < side * (side - 1); ++i) {
    if (i % side == side - 1) {
      continue;
    }
    for (const auto& f :
         {std::array{i, i + 1, i + 1 + side}, std::array{i, i + 1 + side, i + side}}) {
      const int base = extension == ".ply" ? 0 : 1;
      const std::string corners = std::to_string(f[0] + base) + " " + std::to_string(f[1] + base) +
                                  " " + std::to_string(f[2] + base);
      triangles += extension == ".obj" ? "f " + corners + "\n"
                   : extension == ".2dm"
                       ? "E3T " + std::to_string(++number) + " " + corners + " 1\n"
                       : "3 " + corners + "\n";
    }
  }
  if (extension == ".2dm") {
    return "MESH2D\n" + triangles + vertices;  // as programs write it
  }
  const std::string header = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                             "\nproperty double x\nproperty double y\nproperty double z\n"
                             "element face " +
                             std::to_string(2 * (side - 1) * (side - 1)) +
                             "\nproperty list uchar int vertex_indices\nend_header\n";
  return (extension == ".ply" ? header : "") + vertices + triangles;
}

TEST(PointCount, KnowsHowManyVerticesOfTinsAreSortedAtOnce) {
  const oracle::ScratchFolder folder;
  std::vector<std::string> paths;
  for (const int side : {10, 30, 20}) {
    paths.push_back(folder.file(std::to_string(side) + ".ply"));
    oracle::write_text(paths.back(), mesh(".ply", side));
  }
  const PointCount count = count_points(paths, {});
  EXPECT_EQ(count.of_tins_at_once(1), 900U);
  EXPECT_EQ(count.of_tins_at_once(2), 1300U);
  EXPECT_EQ(count.of_tins_at_once(9), 1400U);
  EXPECT_EQ(count.points, 1400U);
}

TEST(PointCount, KnowsTheVerticesOfTinsWithoutReadingAllOfThem) {
  const oracle::ScratchFolder folder;
  for (const std::string extension : {".obj", ".2dm", ".ply"}) {
    SCOPED_TRACE(extension);
    for (const int side : {30, 300}) {
      const std::string path = folder.file("m" + extension);
      oracle::write_text(path, mesh(extension, side));
      const PointCount count = count_points({path}, {});
      EXPECT_EQ(count.of_tins_at_once(1), count.points);
      const double ratio = static_cast<double>(count.points) / (side * side);
      if (side == 30 || extension == ".ply") {
        EXPECT_EQ(ratio, 1.0);
      }
      EXPECT_GT(ratio, 0.9);
      EXPECT_LT(ratio, 1.2);
    }
  }
}

/// A TIN that cannot fit is refused before it is read.
TEST(PointPlan, OfATinIsMadeBeforeItIsRead) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("m.ply"), mesh(".ply", 300));
  BuildPlan plan;
  BuildResources resources;
  resources.dry_run = true;
  int stages = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_plan = [&](const BuildPlan& p) { plan = p; };
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    stages += std::string(name) == "reading" ? 1 : 0;
  };
  build({folder.file("m.ply")}, folder.file("out.ptin"), {}, resources);
  EXPECT_TRUE(plan.is_estimate);
  EXPECT_EQ(stages, 0);
  EXPECT_GE(plan.temporary_bytes, 500U * 90000U);
  BuildOptions repair;
  repair.repair = true;
  build({folder.file("m.ply")}, folder.file("out.ptin"), repair, resources);
  EXPECT_GE(plan.temporary_bytes, (27U + 272U) * 90000U);
  EXPECT_EQ(stages, 0);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"m.ply"});
}

}  // namespace
}  // namespace ptin
