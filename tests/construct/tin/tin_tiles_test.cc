// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs with pockets and holes built through a tree of tiles into a store, and the promises of
// engine/DESIGN.md, section 2.8, held against all their vertices and triangles.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/query/questions.h"
#include "tests/construct/border_oracle.h"
#include "tests/construct/delaunay_tin.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/point_sets.h"
#include "tests/construct/store_promises.h"
#include "tests/construct/tin/holed_ply.h"
#include "tests/construct/told_build.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

/// What the oracles ask, from the triangles in one piece.
TestTerrain terrain_in(const std::string& path, const std::string& folder) {
  const TinTriangles triangles = TinTriangles::read(path, {}, {FileLayer::system(), folder});
  TestTerrain terrain;
  terrain.full = triangles.part(0, 1);
  terrain.tile.units.heights = triangles.frame().heights;
  for (const Vertex& v : terrain.full.vertices) {
    terrain.samples.push_back({v.position, triangles.frame().heights.code(v.height), true});
  }
  oracle::measure_depths(terrain);
  terrain.slope = BuildOptions{}.void_slope;
  return terrain;
}

struct TinCase {
  PointKind kind;
  std::uint64_t points;
  std::int64_t tile;
  int holes_of_ten;
  CostModel cost = CostModel::kError;
};

void expect_promises(const TinCase& c) {
  SCOPED_TRACE(name_of(c.kind) + ", " + std::to_string(c.points) + " points, tiles of " +
               std::to_string(c.tile) + ", holes " + std::to_string(c.holes_of_ten));
  const oracle::ScratchFolder folder;
  const std::string input = folder.file("in.ply");
  oracle::write_text(input, test::holed_ply(c.kind, c.points, c.points, c.holes_of_ten));
  const TestTerrain terrain = terrain_in(input, folder.file(""));
  ASSERT_EQ(validate(terrain.full), "");
  BuildOptions options;
  options.tile = c.tile;
  options.cost = c.cost;
  const BuildReport report = build({input}, folder.file("out.ptin"), options, {});
  EXPECT_EQ(report.vertices, terrain.samples.size());
  EXPECT_EQ(folder.names().size(), 2U) << "nothing else is left behind";
  EXPECT_EQ(oracle::check_store(terrain, Terrain::open(folder.file("out.ptin"))), "");
}

TEST(TinsOverTiles, KeepTheirPromises) {
  for (const PointKind kind : test::some_of(kPointKinds)) {
    expect_promises({kind, 500, 8, 3});
    expect_promises({kind, 400, 5, 0, CostModel::kRoi});
  }
}

TEST(TinsOverTiles, KeepTheirPromisesWithAlmostNothingInATile) {
  for (const PointKind kind : test::some_of(kPointKinds, 2, 1)) {
    expect_promises({kind, 40, 2, 6});
    expect_promises({kind, 300, 4, 9});
  }
}

TEST(TinsOverTiles, SortTheSameOnDiskAndInMemory) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.ply"), test::holed_ply(PointKind::kEven, 9000, 3, 1));
  const auto read = [&](std::uint64_t bytes) {
    return TinTriangles::read(folder.file("in.ply"), {},
                              {FileLayer::system(), folder.file(""), bytes})
        .part(0, 1);
  };
  const Tin small = read(std::uint64_t{1} << 20), large = read(std::uint64_t{1} << 28);
  ASSERT_EQ(small.triangles.size(), large.triangles.size());
  ASSERT_EQ(small.vertices.size(), large.vertices.size());
  for (std::size_t t = 0; t < small.triangles.size(); ++t) {
    ASSERT_TRUE(std::equal(small.triangles[t].v, small.triangles[t].v + 3, large.triangles[t].v));
    ASSERT_EQ(small.classes[t], large.classes[t]);
  }
  for (std::size_t v = 0; v < small.vertices.size(); ++v) {
    ASSERT_EQ(small.vertices[v].position, large.vertices[v].position);
    ASSERT_EQ(small.vertices[v].height, large.vertices[v].height);
  }
}

TEST(TinsOverTiles, GiveTheSameBytesWithAnyThreadsAndMemoryAndAfterAStop) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.ply"), test::holed_ply(PointKind::kClusters, 1500, 2, 4));
  BuildOptions options;
  options.tile = 8;
  const auto built = [&](const char* name, const BuildResources& resources) {
    build({folder.file("in.ply")}, folder.file(name), options, resources);
    return oracle::bytes_of(folder.file(name));
  };
  BuildResources resources;
  resources.threads = 1;
  const std::string expected = built("one", resources);
  resources.threads = 3;
  EXPECT_TRUE(built("three", resources) == expected);
  resources.memory_bytes = std::uint64_t{768}
                           << 20;  // what a sanitizer keeps of freed memory counts
  EXPECT_TRUE(built("small", resources) == expected);
  for (const std::uint64_t moment : test::some_of<std::uint64_t>({1, 40, 200, 900})) {
    std::stop_source stop;
    resources.stop = stop.get_token();
    resources.checkpoint_interval = std::chrono::milliseconds(0);
    oracle::ToldBuild told;
    resources.observer = &told;
    told.on_stage = [&, calls = std::uint64_t{0}](const char*, std::uint64_t,
                                                  std::uint64_t) mutable {
      if (++calls == moment) {
        stop.request_stop();
      }
    };
    try {
      built("stopped", resources);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
    resources.stop = {};
    resources.unfinished = Unfinished::kResume;
    resources.overwrite = true;
    EXPECT_TRUE(built("stopped", resources) == expected) << "stopped at call " << moment;
  }
}

}  // namespace
}  // namespace ptin
