// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/cut.h"

#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tools/region/tin_mesh.h"

namespace ptin::tools {
namespace {

constexpr std::int32_t kSide = 8;

struct CutTerrain {
  StoreFacts facts;
  RefinedTin refined;
};

double plane(double x, double y) { return 2 * x + 3 * y + 1; }

/// A grid of 9 x 9 vertices on a plane, map = 100 + 10 * grid; diagonals at random, cell (2, 3)
/// void.
CutTerrain grid_terrain(unsigned seed) {
  CutTerrain made;
  made.facts.map = {100.0, 100.0, 10.0, 10.0};
  made.facts.heights = {HeightType::float32, 1.0, 0.0};
  made.facts.bounds = {0, 0, kSide, kSide};
  Tin& tin = made.refined.tin;
  for (std::int32_t y = 0; y <= kSide; ++y) {
    for (std::int32_t x = 0; x <= kSide; ++x) {
      tin.vertices.push_back({{x, y}, made.facts.heights.bits(plane(x, y)), kNone});
      tin.has_height.push_back(1);
    }
  }
  std::mt19937 random(seed);
  const auto id = [](std::int32_t x, std::int32_t y) {
    return static_cast<VertexId>(y * (kSide + 1) + x);
  };
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const VertexId a = id(x, y), b = id(x + 1, y), c = id(x + 1, y + 1), d = id(x, y + 1);
      const bool rising = random() % 2 == 0;
      for (const Triangle& t : {rising ? Triangle{{a, b, c}, {}} : Triangle{{a, b, d}, {}},
                                rising ? Triangle{{a, c, d}, {}} : Triangle{{b, c, d}, {}}}) {
        tin.triangles.push_back(t);
        tin.classes.push_back(x == 2 && y == 3 ? TriangleClass::kVoid : TriangleClass::kSurface);
      }
    }
  }
  std::map<std::pair<VertexId, VertexId>, TriangleId> owner;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i)
      owner[{tin.triangles[t].v[next_corner(i)], tin.triangles[t].v[previous_corner(i)]}] = t;
  }
  for (Triangle& t : tin.triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto it = owner.find({t.v[previous_corner(i)], t.v[next_corner(i)]});
      t.n[i] = it == owner.end() ? kNone : it->second;
    }
  }
  return made;
}

using Point = std::array<double, 3>;

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Point &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    EXPECT_GT(twice, 0) << "a triangle is turned over or flat";
    area += twice / 2;
  }
  return area;
}

/// Edges with a triangle on one side only; fails when three triangles meet in an edge.
std::vector<std::array<Point, 2>> outline_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ((++directed[{t[i], t[(i + 1) % 3]}]), 1) << "an edge twice in one direction";
  }
  std::vector<std::array<Point, 2>> outline;
  for (const auto& [edge, count] : directed) {
    if (!directed.contains({edge.second, edge.first}))
      outline.push_back({mesh.vertices[edge.first], mesh.vertices[edge.second]});
  }
  return outline;
}

void expect_on_plane(const Mesh& mesh) {
  for (const Point& p : mesh.vertices)
    EXPECT_NEAR(p[2], plane((p[0] - 100) / 10, (p[1] - 100) / 10), 1e-4);
}

/// True when both ends lie on one straight piece of the border of the region, the terrain or the
/// void cell.
bool is_on_border(const std::array<Point, 2>& edge,
                  const std::vector<std::vector<MapPoint>>& rings) {
  const auto lies_on = [](const Point& p, const MapPoint& a, const MapPoint& b) {
    const double cross = (b.x - a.x) * (p[1] - a.y) - (b.y - a.y) * (p[0] - a.x);
    return std::abs(cross) < 1e-4 * (std::abs(b.x - a.x) + std::abs(b.y - a.y) + 1);
  };
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const MapPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if (lies_on(edge[0], a, b) && lies_on(edge[1], a, b)) return true;
    }
  }
  return false;
}

std::vector<MapPoint> square(double low_x, double low_y, double high_x, double high_y) {
  return {{low_x, low_y}, {high_x, low_y}, {high_x, high_y}, {low_x, high_y}};
}

void expect_no_crack(const Mesh& mesh, std::vector<std::vector<MapPoint>> rings) {
  rings.push_back(square(100, 100, 180, 180));  // the terrain
  rings.push_back(square(120, 130, 130, 140));  // its void cell
  for (const auto& edge : outline_of(mesh))
    EXPECT_TRUE(is_on_border(edge, rings)) << "a crack inside of the region";
}

double overlap(double a, double b, double c, double d) {
  return std::max(0.0, std::min(b, d) - std::max(a, c));
}

double surface_area(const Window& w) {
  return overlap(w.min_x, w.max_x, 100, 180) * overlap(w.min_y, w.max_y, 100, 180) -
         overlap(w.min_x, w.max_x, 120, 130) * overlap(w.min_y, w.max_y, 130, 140);
}

TEST(CutToRegion, GivesExactlyTheWindow) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anywhere(80, 200);
  for (unsigned i = 0; i < 300; ++i) {
    const CutTerrain terrain = grid_terrain(i);
    Window w{anywhere(random), anywhere(random), anywhere(random), anywhere(random)};
    if (w.min_x > w.max_x) std::swap(w.min_x, w.max_x);
    if (w.min_y > w.max_y) std::swap(w.min_y, w.max_y);
    const Mesh mesh = cut_to_region(terrain.refined, terrain.facts, w);
    EXPECT_NEAR(area_of(mesh), surface_area(w), 1e-6);
    expect_on_plane(mesh);
    expect_no_crack(mesh, {square(w.min_x, w.min_y, w.max_x, w.max_y)});
    for (const Point& p : mesh.vertices) {
      EXPECT_TRUE(p[0] >= w.min_x && p[0] <= w.max_x && p[1] >= w.min_y && p[1] <= w.max_y)
          << "outside of the window";
    }
  }
}

TEST(CutToRegion, GoesThroughVerticesAndAlongEdges) {
  for (unsigned i = 0; i < 100; ++i) {
    const CutTerrain terrain = grid_terrain(i);
    for (const Window& w :
         {Window{100, 100, 180, 180}, Window{120, 110, 150, 170}, Window{90, 130, 140, 130 + 1e-9},
          Window{105, 105, 175, 175}, Window{110, 115, 110 + 20, 195}, Window{0, 0, 1000, 1000}}) {
      const Mesh mesh = cut_to_region(terrain.refined, terrain.facts, w);
      EXPECT_NEAR(area_of(mesh), surface_area(w), 1e-5);
      expect_no_crack(mesh, {square(w.min_x, w.min_y, w.max_x, w.max_y)});
    }
  }
}

TEST(CutToRegion, GoesThroughVerticesWhereDoublesAreCoarserThanSpots) {
  CutTerrain terrain = grid_terrain(4);
  // The map coordinate of a vertex leads back to within 5e-7 of its grid coordinate.
  terrain.facts.map = {500000.1, 5000000.1, 0.001, 0.001};
  const MapPoint low = terrain.facts.map.to_map(2, 1), high = terrain.facts.map.to_map(6, 7);
  const Window window{low.x, low.y, high.x, high.y};
  const Polygon polygon{{square(low.x, low.y, high.x, high.y)}};
  for (const Region& region : {Region(window), Region(polygon)}) {
    const Mesh mesh = cut_to_region(terrain.refined, terrain.facts, region);
    EXPECT_EQ(mesh.vertices.size(), 5U * 7U);
    EXPECT_EQ(mesh.triangles.size(), 2U * 4U * 6U - 2U);
  }
}

TEST(CutToRegion, GivesNothingOutsideOfTheTerrainOrInAVoid) {
  const CutTerrain terrain = grid_terrain(1);
  EXPECT_TRUE(
      cut_to_region(terrain.refined, terrain.facts, Window{300, 300, 400, 400}).triangles.empty());
  EXPECT_TRUE(
      cut_to_region(terrain.refined, terrain.facts, Window{122, 132, 128, 138}).triangles.empty());
}

TEST(CutToRegion, JoinsWindowsThatShareASide) {
  const CutTerrain terrain = grid_terrain(5);
  const Mesh left = cut_to_region(terrain.refined, terrain.facts, Window{103, 104, 141.3, 177});
  const Mesh right = cut_to_region(terrain.refined, terrain.facts, Window{141.3, 102, 178, 179});
  const auto on_side = [](const Mesh& mesh) {
    std::set<Point> points;
    for (const Point& p : mesh.vertices) {
      if (p[0] == 141.3 && p[1] > 104 && p[1] < 177) points.insert(p);
    }
    return points;
  };
  EXPECT_GT(on_side(left).size(), 10U);
  EXPECT_EQ(on_side(left), on_side(right));  // the same bits
}

TEST(CutToRegion, CutsPolygonsWithHolesAndDents) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> radius(8, 33);
  std::uniform_real_distribution<double> middle(133, 147);
  for (unsigned i = 0; i < 200; ++i) {
    const CutTerrain terrain = grid_terrain(i);
    Polygon star;
    const MapPoint centre{middle(random), middle(random)};
    std::vector<MapPoint> shell;
    std::vector<MapPoint> hole;
    const int corners = 5 + static_cast<int>(i % 40);
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * M_PI * k / corners;
      const double r = radius(random);
      shell.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle)});
      hole.push_back({centre.x + 3 * std::cos(-angle), centre.y + 3 * std::sin(-angle)});
    }
    star.rings = {shell, hole};
    double area = 0;
    for (int k = 0; k < corners; ++k) {
      for (const auto* ring : {&shell, &hole}) {
        const MapPoint a = (*ring)[static_cast<std::size_t>(k)];
        const MapPoint b = (*ring)[static_cast<std::size_t>((k + 1) % corners)];
        area += (a.x * b.y - b.x * a.y) / 2;
      }
    }
    CutTerrain whole = terrain;
    for (TriangleClass& c : whole.refined.tin.classes) c = TriangleClass::kSurface;
    const Mesh mesh = cut_to_region(whole.refined, whole.facts, star);
    EXPECT_NEAR(area_of(mesh), area, 1e-3) << "polygon " << i;
    expect_on_plane(mesh);
    expect_no_crack(mesh, star.rings);
  }
}

TEST(CutToRegion, CutsAPolygonThatReachesOutside) {
  const CutTerrain terrain = grid_terrain(2);
  Polygon triangle;
  triangle.rings = {
      {{0, 0}, {300, 0}, {0, 300}}};  // x + y <= 300 holds three quarters of the terrain and more
  const Mesh mesh = cut_to_region(terrain.refined, terrain.facts, triangle);
  EXPECT_NEAR(area_of(mesh), 6400 - 60 * 60 / 2.0 - 100, 1e-5);
  expect_no_crack(mesh, triangle.rings);
}

TEST(CutToRegion, RefusesRegionsWithoutAnInside) {
  const CutTerrain terrain = grid_terrain(2);
  EXPECT_THROW(static_cast<void>(cut_to_region(terrain.refined, terrain.facts, MapPoint{110, 110})),
               Error);
}

TEST(SurfaceMesh, LeavesVoidsOut) {
  const CutTerrain terrain = grid_terrain(2);
  const Mesh mesh = surface_mesh(terrain.refined, terrain.facts);
  EXPECT_EQ(mesh.triangles.size(), 2U * kSide * kSide - 2U);
  EXPECT_NEAR(area_of(mesh), 6300, 1e-9);
}

}  // namespace
}  // namespace ptin::tools
