// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs with pockets and holes built through a tree of tiles into a store, and the promises of
// engine/DESIGN.md, section 2.8, held against all their vertices and triangles.
#include <algorithm>
#include <limits>
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
#include "tests/construct/told_build.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

/// A Delaunay triangulation without the triangles in some squares of the plane, in a binary PLY.
std::string ply_of(PointKind kind, std::uint64_t n, std::uint64_t seed, int holes_of_ten) {
  const TestTerrain terrain =
      oracle::make_points({"", points_of(kind, n, seed), [](GridPoint p) {
                             return static_cast<double>(key_of(p) * 0x9e3779b97f4a7c15U >> 54);
                           }});
  const Tin& tin = terrain.full;
  GridBox box;
  for (const Vertex& v : tin.vertices) {
    box = united(box, v.position);
  }
  const auto is_kept = [&](const Triangle& t) {
    const GridPoint a = tin.position(t.v[0]);
    const std::uint64_t cell =
        std::uint64_t(8.0 * (a.x - box.min_x) / (1.0 + box.max_x - box.min_x)) +
        8 * std::uint64_t(8.0 * (a.y - box.min_y) / (1.0 + box.max_y - box.min_y));
    return static_cast<int>(((cell + seed + 3) * 0x9e3779b97f4a7c15U >> 40) % 10) >= holes_of_ten;
  };
  std::string faces, vertices;
  const auto put = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::uint64_t count = 0;
  for (const Triangle& t : tin.triangles) {
    if (is_kept(t) || &t == &tin.triangles.front()) {
      put(faces, std::uint8_t{3});
      for (const VertexId v : t.v) put(faces, static_cast<std::int32_t>(v));
      ++count;
    }
  }
  for (const Vertex& v : tin.vertices) {
    put(vertices, static_cast<double>(v.position.x));
    put(vertices, static_cast<double>(v.position.y));
    put(vertices, static_cast<float>(terrain.tile.units.heights.code(v.height)));
  }
  return "ply\nformat binary_little_endian 1.0\nelement vertex " +
         std::to_string(tin.vertices.size()) +
         "\nproperty double x\nproperty double y\nproperty float z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

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
  oracle::write_text(input, ply_of(c.kind, c.points, c.points, c.holes_of_ten));
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
  for (const PointKind kind : test::some_of(kPointKinds)) {
    expect_promises({kind, 40, 2, 6});
    expect_promises({kind, 300, 4, 9});
  }
}

TEST(TinsOverTiles, SortTheSameOnDiskAndInMemory) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.ply"), ply_of(PointKind::kEven, 9000, 3, 1));
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
  oracle::write_text(folder.file("in.ply"), ply_of(PointKind::kClusters, 1500, 2, 4));
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
#ifdef __SANITIZE_ADDRESS__  // What it keeps of freed memory counts.
  resources.memory_bytes = std::uint64_t{768} << 20;
#else
  resources.memory_bytes = std::uint64_t{160} << 20;
#endif
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
