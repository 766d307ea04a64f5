// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points built through a tree of tiles into a store, and the promises of engine/DESIGN.md, section 2.8, held
// against the points and their one Delaunay triangulation.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/delaunay/point_tile.h"
#include "engine/construct/hierarchy/tile_push.h"
#include "engine/construct/tile/part_surface.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/construct/border_oracle.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/point_sets.h"
#include "tests/construct/store_promises.h"
#include "tests/construct/tin_surface.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

/// The terrain of a set of points as text_of() writes them.
TestTerrain terrain_of(PointKind kind, std::uint64_t n, std::uint64_t seed) {
  return oracle::make_points({name_of(kind), points_of(kind, n, seed),
                              [](GridPoint p) { return std::stod(height_text(p)); }});
}

/// Makes triangles with an edge above `longest` void, and points without others too.
void make_voids(TestTerrain& terrain, double longest) {
  Tin& tin = terrain.full;
  std::vector<std::uint8_t> surface(tin.vertices.size(), 0);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    double longest_here = 0.0;
    for (int i = 0; i < 3; ++i) {
      const GridPoint a = tin.position(tin.triangles[t].v[i]);
      const GridPoint b = tin.position(tin.triangles[t].v[next_corner(i)]);
      longest_here = std::max(longest_here, std::hypot(double(a.x) - b.x, double(a.y) - b.y));
    }
    if (longest_here > longest) {
      tin.classes[t] = TriangleClass::kVoid;
      continue;
    }
    for (const VertexId v : tin.triangles[t].v) {
      surface[v] = 1;
    }
  }
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    if (surface[v] == 0) {
      tin.has_height[v] = 0;
      terrain.samples[v].has_height = false;
    }
  }
  oracle::measure_depths(terrain);
  terrain.slope = BuildOptions{}.void_slope;
}

struct PointCase {
  PointKind kind;
  std::uint64_t points;
  std::int64_t tile;
  std::optional<double> max_edge;
  CostModel cost = CostModel::kError;
};

void expect_promises(const PointCase& c) {
  SCOPED_TRACE(name_of(c.kind) + ", " + std::to_string(c.points) + " points, tiles of " +
               std::to_string(c.tile) + (c.max_edge ? ", voids" : ""));
  TestTerrain terrain = terrain_of(c.kind, c.points, c.points);
  if (c.max_edge) {
    make_voids(terrain, *c.max_edge);
  }
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.xyz"), text_of(points_of(c.kind, c.points, c.points)));
  BuildOptions options;
  options.tile = c.tile;
  options.max_edge = c.max_edge;
  options.cost = c.cost;
  const BuildReport report = build({folder.file("in.xyz")}, folder.file("out.ptin"), options, {});
  EXPECT_EQ(report.vertices, terrain.samples.size());
  EXPECT_EQ(folder.names().size(), 2U) << "nothing else is left behind";
  EXPECT_EQ(oracle::check_store(terrain, Terrain::open(folder.file("out.ptin"))), "");
}

TEST(PointsOverTiles, KeepTheirPromises) {
  for (const PointKind kind : test::some_of(kPointKinds)) {
    expect_promises({kind, 500, 8, {}});
    expect_promises({kind, 300, 4, {}, CostModel::kRoi});
  }
}

TEST(PointsOverTiles, KeepTheirPromisesWithAlmostNothingInATile) {
  for (const PointKind kind : test::some_of(kPointKinds, 2, 1)) {
    for (const std::uint64_t n : {3, 40}) {
      expect_promises({kind, n, 2, {}});
    }
  }
}

TEST(PointsOverTiles, KeepTheirPromisesWithVoids) {
  const std::vector<PointCase> cases = {{PointKind::kEven, 600, 8, 200.0},
                                        {PointKind::kEven, 600, 8, 60.0, CostModel::kElevation},
                                        {PointKind::kClusters, 600, 8, 2000.0},
                                        {PointKind::kCorridor, 600, 8, 4000.0},
                                        {PointKind::kGrid, 900, 8, 1.4},  // no triangle is left
                                        {PointKind::kGrid, 900, 8, 1.5},  // no voids
                                        {PointKind::kOutliers, 1200, 8, 300.0}};
  for (const PointCase& c : test::some_of(cases)) {
    expect_promises(c);
  }
}

TEST(PointsOverTiles, GiveTheSameBytesForAnyNumberOfThreads) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.xyz"), text_of(points_of(PointKind::kClusters, 1000, 2)));
  BuildOptions options;
  options.tile = 12;
  options.max_edge = 5000.0;
  for (const int threads : {1, 3}) {
    BuildResources resources;
    resources.threads = threads;
    build({folder.file("in.xyz")}, folder.file(std::to_string(threads)), options, resources);
  }
  EXPECT_TRUE(oracle::bytes_of(folder.file("1")) == oracle::bytes_of(folder.file("3")));
}

/// Voids of points in degrees, whose tiles see each edge in the same metres.
TEST(PointsOverTiles, TakeTheLongestEdgeInMetresWherePlacesAreDegrees) {
  // At 60 degrees north 0.001 degrees are 111.4 m to the north and 55.8 m to the east.
  std::string text;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const int east = x < 20 ? x : 3 * x;  // three times as far apart in the east
      text += std::to_string(10.0 + 0.001 * east) + "," + std::to_string(60.0 + 0.001 * y) + ",5\n";
    }
  }
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.csv"), text);
  const auto lone = [&](double longest) {
    BuildOptions options;
    options.tile = 10;
    options.a_srs = "EPSG:4326";
    options.max_edge = longest;
    BuildResources resources;
    resources.overwrite = true;
    return build({folder.file("in.csv")}, folder.file("out.ptin"), options, resources).lone_samples;
  };
  EXPECT_EQ(lone(210.0), 0U) << "diagonals of 167 m by 111 m are 201 m long";
  EXPECT_EQ(lone(130.0), 800U) << "diagonals of 56 m by 111 m are 125 m long";
  EXPECT_EQ(lone(120.0), 1600U);
}

// ---------------------------------------------------------------------------------------------------
// The parts.

class PointTiles : public testing::TestWithParam<PointKind> {};

/// The largest gap over all parts is that over the whole.
TEST_P(PointTiles, PartsOfTheSurfaceAreTheWhole) {
  const TestTerrain terrain = terrain_of(GetParam(), 2000, 9);
  const PointBuckets buckets = buckets_of(GetParam(), 2000, 9);
  const TileTree tree =
      TileTree::over_points(buckets.size(), 6, std::make_shared<const ConvexHull>(buckets.hull()));
  const oracle::TinSurface whole(terrain.full, terrain.tile.units.heights);
  PointTileStarter starter(buckets, tree, terrain.tile.units, {});
  std::vector<StartedTile> parts;
  for (std::int64_t y = 0; y * y < static_cast<std::int64_t>(tree.leaves()); ++y) {
    for (std::int64_t x = 0; x * x < static_cast<std::int64_t>(tree.leaves()); ++x) {
      parts.push_back(starter.start(tree.window({0, x, y})));
    }
  }
  ASSERT_GE(parts.size(), 4U);
  std::mt19937_64 random(5);
  const auto end_of = [&](VertexId v) {
    return EdgeEnd{terrain.full.position(v),
                   terrain.tile.units.heights.code(terrain.full.vertices[v].height)};
  };
  for (int i = 0; i < 400; ++i) {
    const auto n = terrain.full.vertices.size();
    const auto from = static_cast<VertexId>(random() % n);
    const auto to = i % 3 == 0 ? static_cast<VertexId>((from + 1 + random() % 40) % n)
                               : static_cast<VertexId>(random() % n);
    if (from == to) {
      continue;
    }
    const EdgeEnd a = end_of(from), b = end_of(to);
    double largest = 0.0;
    for (const StartedTile& part : parts) {
      largest = std::max(largest, part.full->largest_gap(a, b));
    }
    EXPECT_NEAR(largest, whole.largest_gap(a, b), 1e-9 * (1.0 + largest))
        << a.position.x << ' ' << a.position.y << " to " << b.position.x << ' ' << b.position.y;
  }
}

/// A vertex is locked when some of its triangles are in other tiles.
TEST_P(PointTiles, LocksVerticesWithTrianglesInOtherTiles) {
  const TestTerrain terrain = terrain_of(GetParam(), 3000, 4);
  std::map<VertexKey, int> triangles;
  for (const Triangle& t : terrain.full.triangles) {
    for (const VertexId v : t.v) {
      ++triangles[key_of(terrain.full.position(v))];
    }
  }
  const PointBuckets buckets = buckets_of(GetParam(), 3000, 4);
  const TileTree tree =
      TileTree::over_points(buckets.size(), 6, std::make_shared<const ConvexHull>(buckets.hull()));
  PointTileStarter starter(buckets, tree, terrain.tile.units, {});
  for (std::int64_t i = 0; i < 8; ++i) {
    Tile tile = starter.start(tree.window({0, i % 4, i / 4})).tile;
    lock_seams(tile, tree, {0, 0, 0});
    std::vector<int> here(tile.tin.vertices.size(), 0);
    for (const Triangle& t : tile.tin.triangles) {
      for (const VertexId v : t.v) {
        ++here[v];
      }
    }
    for (VertexId v = 0; v < here.size(); ++v) {
      ASSERT_EQ(tile.vertex_state[v].locked, here[v] < triangles[key_of(tile.tin.position(v))]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PointTiles, testing::ValuesIn(kPointKinds),
                         [](const auto& kind) { return name_of(kind.param); });

TEST(TileTreeOverPoints, LeavesFollowTheCurve) {
  const auto hull = std::make_shared<const ConvexHull>();
  EXPECT_EQ(TileTree::over_points(100, 10, hull).leaves(), 1U);
  EXPECT_EQ(TileTree::over_points(101, 10, hull).leaves(), 4U);
  EXPECT_EQ(TileTree::over_points(400, 10, hull).leaves(), 4U);
  EXPECT_EQ(TileTree::over_points(401, 10, hull).leaves(), 16U);
  const TileTree tree = TileTree::over_points(std::uint64_t{1} << 40, 512, hull);
  EXPECT_EQ(tree.leaves(), std::uint64_t{1} << 22);
  // The leaves of every tile are one piece of the curve.
  for (std::uint64_t i = 0; i < 4; ++i) {
    const TileId id{2, static_cast<std::int64_t>(i * 7 % 5), static_cast<std::int64_t>(i * 3)};
    std::vector<std::uint64_t> numbers;
    for (const TileId& child : tree.children(id)) {
      for (const TileId& leaf : tree.children(child)) {
        numbers.push_back(tree.leaf_number(tree.window(leaf)));
      }
    }
    std::sort(numbers.begin(), numbers.end());
    EXPECT_EQ(numbers.size(), 16U);
    EXPECT_EQ(numbers.back() - numbers.front(), 15U);
    EXPECT_EQ(numbers.front() % 16, 0U);
  }
}

}  // namespace
}  // namespace ptin
