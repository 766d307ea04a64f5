// SPDX-License-Identifier: GPL-3.0-or-later
//
// Highest and lowest points of polygons against all triangles, in rationals.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/heights/highest.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/polygon_oracle.h"
#include "tests/query/volume/volume_oracle.h"

namespace ptin {
namespace {

using reference::any_polygon;
using reference::distance_to_border;
using reference::Hierarchy;
using reference::polygon_holds;
using reference::Rational;
using reference::rational_of;
using reference::RationalPoint;
using reference::RationalTriangle;
using reference::TemporaryStore;

Rational turn(const RationalPoint& o, const RationalPoint& a, const RationalPoint& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// The places at which a linear function on a triangle can be largest in a polygon: their corners that
/// lie in the other, and where their sides cross.
std::vector<RationalPoint> candidates(const RationalTriangle& t, const Polygon& polygon) {
  std::vector<RationalPoint> places;
  for (const RationalPoint& c : t.corners) {
    if (polygon_holds(polygon, c)) places.push_back(c);
  }
  for (const auto& [a, b] : reference::sides_of(polygon)) {
    bool is_in_triangle = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const RationalPoint &p = t.corners[i], &q = t.corners[(i + 1) % 3];
      const Rational at_a = turn(p, q, a), at_b = turn(p, q, b);
      is_in_triangle = is_in_triangle && at_a >= 0;
      if (at_a * at_b < 0 && turn(a, b, p) * turn(a, b, q) < 0) {
        places.push_back(reference::along(a, b, at_a / (at_a - at_b)));
      }
    }
    if (is_in_triangle) places.push_back(a);
  }
  return places;
}

struct Truth {
  std::optional<double> highest;  ///< Of the surface in the polygon.
  bool meets_domain = false;
};

Truth truth_of(const std::vector<RationalTriangle>& triangles, const Polygon& polygon, int sign) {
  Truth truth;
  for (const RationalTriangle& t : triangles) {
    for (const RationalPoint& p : candidates(t, polygon)) {
      truth.meets_domain = true;
      if (!t.is_surface) continue;
      const double value = sign * t.at(p).convert_to<double>();
      truth.highest = std::max(truth.highest.value_or(value), value);
    }
  }
  return truth;
}

TEST(Highest, OfAPolygonIsThatOfAllTriangles) {
  int on_border = 0, at_vertices = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Hierarchy h = reference::small_terrain(seed);
    const TemporaryStore store(h);
    const Terrain terrain(store.open());
    RefineRequest level;
    if (seed % 2 == 0) level.detail.tolerance = 0.5 * double(seed % 7);
    const auto triangles =
        reference::rational_triangles(terrain.refine(level).tin, terrain.store().facts());
    for (const bool lowest : {false, true}) {
      const Polygon polygon = any_polygon(random, h.facts);
      HighestRequest request;
      request.region = polygon;
      request.lowest = lowest;
      request.detail = level.detail;
      request.listed = 3;
      const HighestResult got = highest(terrain, request);
      const int sign = lowest ? -1 : 1;
      const Truth want = truth_of(triangles, polygon, sign);
      if (!want.highest) {
        EXPECT_EQ(got.state, want.meets_domain ? PointState::kVoid : PointState::kOutside);
        continue;
      }
      ASSERT_EQ(got.state, PointState::kSurface);
      EXPECT_NEAR(sign * got.point.height, *want.highest, 1e-9);
      EXPECT_LE(got.height_min, got.point.height);
      EXPECT_GE(got.height_max, got.point.height);
      const MapPoint p = got.point.position;
      EXPECT_TRUE(polygon_holds(polygon, rational_of(p)) || distance_to_border(polygon, p) < 1e-9);
      if (!got.at_vertex) {
        EXPECT_LE(distance_to_border(polygon, p), 1e-9);
      }
      (got.at_vertex ? at_vertices : on_border) += 1;
      for (const HeightAt& v : got.vertices)
        EXPECT_TRUE(polygon_holds(polygon, rational_of(v.position)));
    }
  }
  EXPECT_GT(on_border, 10);
  EXPECT_GT(at_vertices, 5);
}

/// A side along the border of the terrain, which the polygon touches from without.
TEST(Highest, OfAPolygonThatTouchesTheTerrainLiesOnTheBorderOfBoth) {
  const Hierarchy h = reference::small_terrain(2);
  const TemporaryStore store(h);
  const Terrain terrain(store.open());
  const auto triangles =
      reference::rational_triangles(terrain.refine({}).tin, terrain.store().facts());
  const GridBox& b = h.facts.bounds;
  const double beyond = b.max_x + 3.0, middle = (b.min_y + b.max_y) / 2.0;
  const auto at = [&](double x, double y) { return h.facts.map.to_map(x, y); };
  const Polygon touching{{{at(b.max_x, b.min_y + 0.3), at(beyond, b.min_y - 1.0),
                           at(beyond, b.max_y + 1.0), at(b.max_x, middle + 0.2)}}};
  HighestRequest request;
  request.region = touching;
  const HighestResult got = highest(terrain, request);
  const Truth want = truth_of(triangles, touching, 1);
  ASSERT_TRUE(want.highest);
  EXPECT_EQ(got.state, PointState::kSurface);
  EXPECT_NEAR(got.point.height, *want.highest, 1e-9);
}

TEST(Highest, OfAPolygonLiesWithinTheIntervalThatALevelOfDetailCertifies) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  std::mt19937_64 random(11);
  for (int i = 0; i < 30; ++i) {
    HighestRequest request;
    request.region = any_polygon(random, facts);
    request.lowest = i % 2 == 0;
    const HighestResult exact = highest(terrain, request);
    if (i % 3 == 0) {
      request.detail.vertices = 100 + random() % 20000;
    } else {
      request.detail.tolerance = double(random() % 4000) / 100;
    }
    const HighestResult got = highest(terrain, request);
    ASSERT_EQ(got.state, exact.state);
    if (got.state != PointState::kSurface) continue;
    EXPECT_LE(got.height_min, exact.point.height);
    EXPECT_GE(got.height_max, exact.point.height);
  }
}

TEST(Highest, OfARectangleIsThatOfItsWindow) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const auto share = [&] { return double(random() % 1000003) / 1000003; };
    const GridBox& b = facts.bounds;
    const auto corner = [&] {
      return facts.map.to_map(b.min_x + share() * (b.max_x - b.min_x),
                              b.min_y + share() * (b.max_y - b.min_y));
    };
    const MapPoint p = corner(), q = corner();
    HighestRequest request;
    request.listed = 4;
    request.lowest = i % 2 == 0;
    request.region =
        Window{std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
    const HighestResult window = highest(terrain, request);
    request.region = Polygon{{{p, {q.x, p.y}, q, {p.x, q.y}}}};
    const HighestResult polygon = highest(terrain, request);
    EXPECT_EQ(polygon.state, window.state);
    EXPECT_EQ(polygon.at_vertex, window.at_vertex);
    EXPECT_NEAR(polygon.point.height, window.point.height, 1e-9);
    EXPECT_EQ(polygon.vertices.size(), window.vertices.size());
  }
}

/// No point of the border lies above both ends of an edge, where rounding of areas may put it: of the
/// first two rectangles it did.
TEST(Highest, OfARegionWithSidesAlongRowsOfVerticesIsAVertex) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  std::vector<std::array<GridPoint, 2>> corners = {{{{107, 149}, {85, 7}}},
                                                   {{{85, 18}, {107, 166}}}};
  std::mt19937_64 random(5);
  const auto coordinate = [&](std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random() % (std::uint64_t(high - low) + 1));
  };
  const GridBox& b = facts.bounds;
  for (int i = 0; i < 40; ++i) {
    const GridPoint from{coordinate(b.min_x, b.max_x - 1), coordinate(b.min_y, b.max_y - 1)};
    corners.push_back(
        {from, GridPoint{coordinate(from.x + 1, b.max_x), coordinate(from.y + 1, b.max_y)}});
  }
  for (const auto& [from, to] : corners) {
    const MapPoint p = facts.map.to_map(from.x, from.y), q = facts.map.to_map(to.x, to.y);
    HighestRequest request;
    for (const bool lowest : {true, false}) {
      request.lowest = lowest;
      request.region =
          Window{std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
      EXPECT_TRUE(highest(terrain, request).at_vertex);
      request.region = Polygon{{{p, {q.x, p.y}, q, {p.x, q.y}}}};
      EXPECT_TRUE(highest(terrain, request).at_vertex);
    }
  }
}

TEST(Highest, OfAWindowThatIsOnePlaceIsTheHeightThere) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const MapPoint p = terrain.store().facts().map.to_map(20.25, 30.5);
  HighestRequest request;
  request.region = Window{p.x, p.y, p.x, p.y};
  const HighestResult got = highest(terrain, request);
  ASSERT_EQ(got.state, PointState::kSurface);
  const MapPoint points[] = {p};
  const double height = terrain.locate(points, {}).points[0].height;
  EXPECT_NEAR(got.point.height, height, 1e-9);

  // So is one whose sides are shorter than coordinates are told apart, and a polygon of that size.
  const MapPoint q{std::nextafter(p.x, HUGE_VAL), std::nextafter(p.y, HUGE_VAL)};
  for (const Region& region :
       {Region(Window{p.x, p.y, q.x, q.y}), Region(Polygon{{{p, {q.x, p.y}, q, {p.x, q.y}}}})}) {
    request.region = region;
    const HighestResult small = highest(terrain, request);
    ASSERT_EQ(small.state, PointState::kSurface);
    EXPECT_NEAR(small.point.height, height, 1e-9);
  }
}

TEST(Highest, OfAPlaceWithoutInsideIsRefused) {
  const TemporaryStore store(reference::small_terrain(1));
  const Terrain terrain(store.open());
  HighestRequest request;
  request.region = MapPoint{1000, -500};
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
  request.region = Polygon{{{{0, 0}, {1, 1}}}};
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
}

}  // namespace
}  // namespace ptin
