// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains built over a tree of tiles keep every promise of those built as one tile: the records of
// all segments are refined and held against all samples, since carried samples order them and
// tightening must make them true.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/tile_tasks/build_hierarchy.h"
#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "tests/construct/hierarchy/tiled_terrain.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;
using test::build_tiled;
using test::Built;
using test::check_tiled;
using test::hills;
using test::kSamplesAlong;
using test::SampledRaster;
using test::tolerances;

TEST(Hierarchy, KeepsEveryPromiseOnNastyRasters) {
  for (const auto& make : test::some_of(oracle::nasty_rasters())) {
    const TestTerrain terrain = make();
    if (SampledRaster(terrain).at_origin()) {
      for (const std::int64_t side : {3, 8}) {
        EXPECT_EQ(check_tiled(terrain, side), "");
      }
    }
  }
}

TEST(Hierarchy, KeepsEveryPromiseOnLakesAndVoidsInBlocks) {
  for (const auto& make : oracle::lakes()) {
    const TestTerrain terrain = make();
    if (SampledRaster(terrain).at_origin()) {
      EXPECT_EQ(check_tiled(terrain, 16), "");
    }
  }
}

TEST(Hierarchy, SaturatesAcrossSegments) {
  const Built built = build_tiled(hills(65, 3, true), 16);
  // A record that creates a triangle which another's star holds must have larger attributes: looked
  // for by their regions, since dependents lie inside of each other's.
  for (const double tolerance : test::some_of(tolerances(built.records))) {
    std::string fault;
    const Tin tin = oracle::refined(
        built.t0, built.records,
        [&](const VertexSplit& r) { return static_cast<double>(r.error) > tolerance; }, fault);
    EXPECT_EQ(fault, "");
    const Tin coarse = oracle::refined(
        built.t0, built.records,
        [&](const VertexSplit& r) { return static_cast<double>(r.deviation) > tolerance; }, fault);
    EXPECT_EQ(fault, "");
    EXPECT_EQ(validate(coarse), "");
  }
}

double vertices_above(const Built& b, double tolerance) {
  return static_cast<double>(b.t0.alive_vertices()) +
         static_cast<double>(std::count_if(
             b.records.begin(), b.records.end(),
             [&](const VertexSplit& r) { return static_cast<double>(r.error) > tolerance; }));
}

/// Records above a tolerance that windows of this side retrieve: those that pave the terrain, all
/// together.
double records_in_windows(const Built& b, int size, int side, double tolerance) {
  std::size_t count = 0;
  for (const VertexSplit& r : b.records) {
    if (static_cast<double>(r.error) > tolerance) {
      for (int x = 0; x + side < size; x += side) {
        for (int y = 0; y + side < size; y += side) {
          count += meets(r.roi, GridBox{x, y, x + side, y + side}) ? 1 : 0;
        }
      }
    }
  }
  return static_cast<double>(count);
}

/// The same at every sample by itself.
double records_at_points(const Built& b, double tolerance) {
  double count = 0;
  for (const VertexSplit& r : b.records) {
    if (static_cast<double>(r.error) > tolerance) {
      count += (static_cast<double>(r.roi.max_x) - r.roi.min_x + 1) *
               (static_cast<double>(r.roi.max_y) - r.roi.min_y + 1);
    }
  }
  return count;
}

/// 4 x 4 tiles, so small that one sample in 27 is on a seam (of tiles of 256, which builds take,
/// one in 128), over one tile. Counts are those of every run.
constexpr std::int64_t kTileSide = 40;

TEST(Hierarchy, NeedsHardlyMoreVerticesThanOneTile) {
  const TestTerrain terrain = hills(kSamplesAlong, 4, false);
  const Built tiled = build_tiled(terrain, kTileSide);
  const Built whole = build_tiled(terrain, 1000);
  // 1.016, 1.028, 1.016, 0.966, 0.992 and 1.029 when this was written.
  for (const double tolerance : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    EXPECT_LT(vertices_above(tiled, tolerance), 1.05 * vertices_above(whole, tolerance))
        << "tolerance " << tolerance;
  }
}

TEST(Hierarchy, RetrievesHardlyMoreRecordsThanOneTile) {
  const TestTerrain terrain = hills(kSamplesAlong, 4, false);
  const Built tiled = build_tiled(terrain, kTileSide);
  const Built whole = build_tiled(terrain, 1000);
  for (const double tolerance : {0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    SCOPED_TRACE(tolerance);
    // The aim is 1.05 for windows. These have a seam each or two, and the largest of the ratios are
    // 1.033 for windows of 20 and 1.053 for those of 40 (tiles of 80 in 321 x 321: 1.027).
    for (const int side : {20, 40}) {
      EXPECT_LT(records_in_windows(tiled, kSamplesAlong, side, tolerance),
                1.07 * records_in_windows(whole, kSamplesAlong, side, tolerance))
          << "windows of " << side;
    }
    // The aim is 1.10 for points; 0.94 to 0.99: boxes that stay within a tile are smaller.
    EXPECT_LT(records_at_points(tiled, tolerance), 1.03 * records_at_points(whole, tolerance));
  }
}

TEST(Hierarchy, GivesTheSameRecordsTwice) {
  const TestTerrain terrain = hills(65, 5, true);
  const Built alone = build_tiled(terrain, 16);
  EXPECT_TRUE(alone.records == build_tiled(terrain, 16).records);
  for (const int threads : {2, 5}) {
    EXPECT_TRUE(alone.records == build_tiled(terrain, 16, threads).records);
  }
}

TEST(Hierarchy, AThinTerrainIsATreeOfTilesInARow) {
  oracle::RasterSpec spec;
  spec.name = "two samples wide";
  spec.width = 150;
  spec.height = 2;
  spec.code = [](int x, int y) { return (x * 7919 % 31) + 3 * y; };
  EXPECT_EQ(check_tiled(oracle::make_raster(spec), 20), "");
}

/// A terrain that keeps more than the plan counted on.
TEST(Hierarchy, RefusesAJoinThatTheMemoryDoesNotHold) {
  const TestTerrain terrain = hills(65, 3, false);
  const SampledRaster raster(terrain);
  const oracle::ScratchFolder folder;
  test::UnsyncedFiles files;
  Workspace workspace(files, folder.file("t.ptin"), "", Unfinished::kRefuse, {});
  test::RecordsInMemory output;
  HierarchyOptions options;
  options.collapse.units = terrain.tile.units;
  options.memory.tile_bytes.fixed = 0;
  const TileTree tree(raster.width(), raster.height(), 8);
  const LeafStarter start = [&](const SampleRange& w) { return raster.start(w); };
  options.memory.for_tiles = options.memory.tile_bytes.of_batch(100);
  try {
    static_cast<void>(build_hierarchy([&] { return start; }, tree, options, workspace, output));
    FAIL() << "the root joins far more than fits";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("--memory"), std::string::npos) << e.message();
  }
}

}  // namespace
}  // namespace ptin
