// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cutting triangles at the borders of tiles, and which tiles they meet.
#include "tools/tiles/tile_cut.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

TEST(TilePyramid, KnowsWhichTilesLargeTrianglesMeet) {
  const TestFolder folder;
  const Tiled tiled(built_wide(folder));
  const auto globe = std::make_shared<const Globe>(tiled.terrain.store().facts(), tiled.crs);
  const GlobeBox& box = globe->box();
  const TileGrid grid{box.west, box.south, box.east - box.west, box.north - box.south, 1, 1, false};
  // Few triangles, tiles a hundredth as large.
  const std::vector<TileLevel> levels(6, {2000.0, 1000.0, 1.0, 100.0});
  const TilePyramid pyramid(tiled.terrain, globe, grid, levels, {}, limits_of());
  EXPECT_EQ(pyramid.looked_at(), 5);
  std::size_t with_surface = 0;
  for (int z = 0; z < 6; ++z) {
    for (std::int64_t y = 0; y < std::int64_t{1} << z; ++y) {
      for (std::int64_t x = 0; x < std::int64_t{1} << z; ++x) {
        const bool has_surface = !pyramid.mesh({z, x, y}, limits_of()).triangles.empty();
        EXPECT_EQ(pyramid.has_surface({z, x, y}), has_surface) << z << "/" << x << "/" << y;
        with_surface += has_surface ? 1 : 0;
      }
    }
  }
  EXPECT_GT(with_surface, 500U);
  EXPECT_LT(with_surface, 1200U);
}

/// A mesh of small triangles around the corner of four tiles, a vertex every four steps of the
/// lattice or so: cut points are rounded by a large part of an edge.
Tin tin_around_corner(std::mt19937& random) {
  constexpr std::int32_t kSide = 12;
  Tin tin;
  const auto jitter = [&] { return static_cast<std::int32_t>(random() % 3) - 1; };
  for (std::int32_t y = 0; y <= kSide; ++y) {
    for (std::int32_t x = 0; x <= kSide; ++x) {
      tin.vertices.push_back({{32743 + 4 * x + jitter(), 32743 + 4 * y + jitter()},
                              static_cast<HeightBits>(random() % 1000),
                              kNone});
      tin.has_height.push_back(1);
    }
  }
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const auto a = static_cast<VertexId>(y * (kSide + 1) + x);
      const VertexId b = a + 1, d = a + kSide + 1, c = d + 1;
      const bool rising = random() % 2 == 0;
      tin.triangles.push_back(rising ? Triangle{{a, b, c}, {}} : Triangle{{a, b, d}, {}});
      tin.triangles.push_back(rising ? Triangle{{a, c, d}, {}} : Triangle{{b, c, d}, {}});
      tin.classes.insert(tin.classes.end(), 2, TriangleClass::kSurface);
    }
  }
  return tin;
}

TEST(TileCut, CutsNeighboursInTheSamePoints) {
  // The grid is the lattice.
  StoreFacts facts;
  facts.map = {10.0, 10.0, 0x1p-20, 0x1p-20};
  facts.heights = {HeightType::int32, 1.0, 0.0};
  facts.bounds = {0, 0, 65534, 65534};
  facts.max_height = 1000.0;
  const Globe globe(facts, crs_facts(std::string(SRS_WKT_WGS84_LAT_LONG)));
  const TileGrid grid{10.0, 10.0, 32767 * 0x1p-20, 32767 * 0x1p-20, 2, 2, false};
  TileLevel level;
  level.chord = 1e6;
  using Seen = std::set<std::tuple<std::int64_t, std::int64_t, double, std::array<double, 3>>>;
  std::mt19937 random(3);
  std::size_t compared = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Tin tin = tin_around_corner(random);
    // Sides that meet in the corner: west, east, south, north of it, as each tile sees them.
    std::array<std::array<Seen, 4>, 4> seen;
    for (std::int64_t tile = 0; tile < 4; ++tile) {
      const TileBox box = TileGrid::box_of({0, tile % 2, tile / 2});
      const auto path = globe.path();
      LevelMesh mesh({grid, 0, level}, *path, box.widened(TileCut::kNearby, TileCut::kNearby),
                     1000);
      mesh.add(tin, facts, {});
      TileCut cut(mesh, box);
      std::set<TileCut::Id> ids;
      for (const auto& triangle : mesh.triangles()) {
        const auto& polygon = cut.cut(triangle);
        ids.insert(polygon.begin(), polygon.end());
      }
      for (const TileCut::Id id : ids) {
        const LevelPoint& p = cut.point(id);
        const Vec3 n = cut.normal(id);
        const auto see = [&](std::size_t side) {
          seen[static_cast<std::size_t>(tile)][side].insert(
              {p.at.u, p.at.v, p.height, {n.x, n.y, n.z}});
        };
        if (p.at.v == 32767) see(tile % 2 == 0 ? 0 : 1);
        if (p.at.u == 32767) see(tile / 2 == 0 ? 2 : 3);
      }
    }
    EXPECT_EQ(seen[0][0], seen[2][0]);
    EXPECT_EQ(seen[1][1], seen[3][1]);
    EXPECT_EQ(seen[0][2], seen[1][2]);
    EXPECT_EQ(seen[2][3], seen[3][3]);
    compared += seen[0][0].size();
  }
  EXPECT_GT(compared, 1000U);
}

}  // namespace
}  // namespace ptin::tools::testing
