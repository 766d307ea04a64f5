// SPDX-License-Identifier: GPL-3.0-or-later
//
// Highest and lowest points of random windows against all triangles of the full TIN.
#include "engine/query/heights/highest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/heights/locate.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/least_memory.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::Rational;
using reference::TemporaryStore;

struct Brute {
  /// A vertex: its value, negated, and its position, y before x.
  using Vertex = std::array<double, 3>;
  double most = -INFINITY;       ///< Of the surface in the window.
  std::vector<Vertex> vertices;  ///< Falling; of equal values from south to north, west to east.
  bool domain = false;           ///< Some triangle, void or not, meets the window.
};

/// The largest value of a linear function on a triangle within a rectangle lies at a corner, at a
/// corner of the rectangle, or where their sides cross: all are tried.
Brute brute_force(const Tin& tin, const StoreFacts& facts, const Window& w, double sign) {
  Brute b;
  std::vector<std::uint8_t> seen(tin.vertices.size());
  const auto inside = [&](MapPoint p) {
    return w.min_x <= p.x && p.x <= w.max_x && w.min_y <= p.y && p.y <= w.max_y;
  };
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const bool surface = tin.classes[t] == TriangleClass::kSurface;
    const auto reach = [&](double value) {
      b.domain = true;
      if (surface) b.most = std::max(b.most, value);
    };
    MapPoint p[3];
    double z[3];
    for (int i = 0; i < 3; ++i) {
      const VertexId v = tin.triangles[t].v[i];
      p[i] = facts.map.to_map(tin.position(v).x, tin.position(v).y);
      z[i] = sign * facts.heights.height(tin.vertices[v].height);
      if (inside(p[i])) {
        reach(z[i]);
        if (surface && seen[v] == 0) b.vertices.push_back({-z[i], p[i].y, p[i].x});
        seen[v] = surface ? 1 : seen[v];
      }
    }
    for (int i = 0; i < 3; ++i) {
      const MapPoint a = p[i], c = p[(i + 1) % 3];
      const auto cross = [&](double at, double u0, double u1, bool x) {
        if ((u0 < at) == (u1 < at) || u0 == u1) return;
        const double s = (at - u0) / (u1 - u0);
        const MapPoint q{x ? at : a.x + s * (c.x - a.x), x ? a.y + s * (c.y - a.y) : at};
        if (inside(q)) reach(z[i] + s * (z[(i + 1) % 3] - z[i]));
      };
      cross(w.min_x, a.x, c.x, true), cross(w.max_x, a.x, c.x, true);
      cross(w.min_y, a.y, c.y, false), cross(w.max_y, a.y, c.y, false);
    }
    const double area =
        (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    for (const MapPoint q : {MapPoint{w.min_x, w.min_y}, MapPoint{w.max_x, w.min_y},
                             MapPoint{w.max_x, w.max_y}, MapPoint{w.min_x, w.max_y}}) {
      double weight[3];
      for (int i = 0; i < 3; ++i) {
        const MapPoint a = p[(i + 1) % 3], c = p[(i + 2) % 3];
        weight[i] = ((a.x - q.x) * (c.y - q.y) - (c.x - q.x) * (a.y - q.y)) / area;
      }
      if (std::min({weight[0], weight[1], weight[2]}) >= 0) {
        reach(weight[0] * z[0] + weight[1] * z[1] + weight[2] * z[2]);
      }
    }
  }
  std::sort(b.vertices.begin(), b.vertices.end());
  return b;
}

Window window_in(std::mt19937_64& random, const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  // On the grid, or off it so that no corner falls on a diagonal: there the last bit decides
  // whether the window touches a triangle.
  const auto coordinate = [&](std::int32_t low, std::int32_t high) {
    const double on_grid = low - 1 + double(random() % (std::uint64_t(high - low) + 3));
    return random() % 2 == 0 ? on_grid : on_grid + 0.1 + 0.8 * double(random() % 1000003) / 1e6;
  };
  const MapPoint p = facts.map.to_map(coordinate(b.min_x, b.max_x), coordinate(b.min_y, b.max_y));
  const MapPoint q = facts.map.to_map(coordinate(b.min_x, b.max_x), coordinate(b.min_y, b.max_y));
  return {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
}

/// Against all triangles of `tin`, which is what the request asks for.
void check(const HighestResult& got, const HighestRequest& request, const Tin& tin,
           const StoreFacts& facts) {
  const double sign = request.lowest ? -1.0 : 1.0;
  const Window& w = std::get<Window>(*request.region);
  const Brute wanted = brute_force(tin, facts, w, sign);
  RC_ASSERT(got.vertices.size() == std::min<std::size_t>(request.listed, wanted.vertices.size()));
  for (std::size_t k = 0; k < got.vertices.size(); ++k) {
    const HeightAt& v = got.vertices[k];
    RC_ASSERT((Brute::Vertex{-sign * v.height, v.position.y, v.position.x}) == wanted.vertices[k]);
  }
  if (std::isinf(wanted.most)) {
    RC_ASSERT(got.state == (wanted.domain ? PointState::kVoid : PointState::kOutside));
    return;
  }
  RC_ASSERT(got.height_min <= got.point.height);
  RC_ASSERT(got.point.height <= got.height_max);
  RC_ASSERT(got.state == PointState::kSurface);
  RC_ASSERT(std::abs(sign * got.point.height - wanted.most) <= 1e-9);
  const MapPoint p = got.point.position;
  RC_ASSERT((w.min_x - 1e-9 <= p.x && p.x <= w.max_x + 1e-9));
  RC_ASSERT((w.min_y - 1e-9 <= p.y && p.y <= w.max_y + 1e-9));
  if (got.at_vertex) {
    RC_ASSERT(got.point.height == got.vertices.front().height);
    RC_ASSERT(got.point.position.x == got.vertices.front().position.x);
    RC_ASSERT(got.point.position.y == got.vertices.front().position.y);
  }
}

RC_GTEST_PROP(Highest, IsThatOfAllTriangles, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 8; ++i) {
    HighestRequest request;
    request.region = window_in(random, h.facts);
    request.lowest = random() % 2 == 0;
    request.listed = 1 + static_cast<std::uint32_t>(random() % 5);
    check(highest(terrain, request), request, h.full, h.facts);
  }
}

RC_GTEST_PROP(Highest, AtALevelOfDetailIsThatOfItsTriangles, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 6; ++i) {
    RefineRequest level;
    HighestRequest request;
    if (random() % 2 == 0) {
      request.detail.tolerance = level.detail.tolerance = double(random() % 1000) / 100;
    } else {
      request.detail.vertices = level.detail.vertices =
          h.t0.vertices.size() + random() % (h.records.size() + 3);
    }
    request.region = window_in(random, h.facts);
    request.lowest = random() % 2 == 0;
    request.listed = 1 + static_cast<std::uint32_t>(random() % 20);
    const RefinedTin refined = terrain.refine(level);
    const HighestResult got = highest(terrain, request);
    check(got, request, refined.tin, h.facts);
    // Of a number of vertices up to the end of a bin of errors.
    RC_ASSERT(got.certified_error >= refined.certified_error);
    RC_ASSERT(got.certified_deviation >= refined.certified_deviation);
    RC_ASSERT(got.exact == refined.exact);
  }
}

TEST(Highest, LiesWithinTheIntervalThatALevelOfDetailCertifies) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  const Tin full = terrain.refine({}).tin;
  std::mt19937_64 random(11);
  for (const std::uint64_t i : test::some_of_first(40, 3)) {
    HighestRequest request;
    request.region = window_in(random, facts);
    request.lowest = i % 2 == 0;
    if (i % 3 == 0) {
      request.detail.vertices = 100 + random() % 20000;
    } else {
      request.detail.tolerance = double(random() % 4000) / 100;
    }
    const HighestResult got = highest(terrain, request);
    if (got.state != PointState::kSurface) continue;
    const double sign = request.lowest ? -1.0 : 1.0;
    const double truth =
        sign * brute_force(full, facts, std::get<Window>(*request.region), sign).most;
    EXPECT_LE(got.height_min, truth);
    EXPECT_GE(got.height_max, truth);
    EXPECT_EQ(got.height_max - got.height_min > 0,
              got.certified_deviation > 0 || !(got.exact || got.at_vertex));
  }
}

// A plane is highest at a corner of the window, and any level of it is the plane: nothing but rounding
// parts the answer from the truth.
TEST(Highest, OnABorderLiesWithinTheIntervalWhereOnlyRoundingPartsItFromTheTruth) {
  std::mt19937_64 random(7);
  Tin plane = reference::random_grid(random, 12, 12, 97, 0.0);
  for (VertexId v = 0; v < plane.vertices.size(); ++v) {
    const GridPoint p = plane.position(v);
    plane.vertices[v].height = HeightBits(std::int32_t(7 * p.x - 3 * p.y));
  }
  const Hierarchy h = reference::simplify(std::move(plane), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  request.detail.vertices = h.t0.vertices.size();
  const auto share = [&] { return double(random() % 1000003) / 1e6; };
  int rounded = 0;
  for (int i = 0; i < 100; ++i) {
    const GridBox& b = h.facts.bounds;
    const MapPoint low =
        h.facts.map.to_map(b.min_x + 1 + 400 * share(), b.min_y + 1 + 400 * share());
    request.region = Window{low.x, low.y, low.x + 60 * share(), low.y + 60 * share()};
    request.lowest = i % 2 == 0;
    const HighestResult got = highest(terrain, request);
    ASSERT_EQ(got.certified_deviation, 0.0);
    ASSERT_FALSE(got.exact);
    const Window& w = std::get<Window>(*request.region);
    // The map's steps are 1/2, so the window has these positions on the grid.
    const auto code_at = [&](double x, double y) -> Rational {
      return 7 * (Rational(x) - h.facts.map.origin_x) / h.facts.map.step_x -
             3 * (Rational(y) - h.facts.map.origin_y) / h.facts.map.step_y;
    };
    const Rational code = request.lowest ? code_at(w.min_x, w.max_y) : code_at(w.max_x, w.min_y);
    const Rational truth = Rational(h.facts.heights.offset) + h.facts.heights.step * code;
    EXPECT_LE(Rational(got.height_min), truth) << i;
    EXPECT_GE(Rational(got.height_max), truth) << i;
    EXPECT_LT(got.height_max - got.height_min, 1e-9);
    rounded += got.point.height != truth ? 1 : 0;
  }
  EXPECT_GT(rounded, 10);
}

/// A grid in which single samples, cut off from all others by voids, are the highest.
Hierarchy hierarchy_with_lone_samples(std::mt19937_64& random, int side) {
  Tin full = reference::random_grid(random, side, side, 4, 0.15);
  std::vector<std::uint8_t> on_surface(full.vertices.size());
  std::vector<std::uint8_t> lone(full.vertices.size());
  const auto corners = [&](TriangleId t) { return std::span(full.triangles[t].v, 3); };
  for (VertexId v = 0; v < lone.size(); ++v)
    lone[v] = random() % 12 == 0 && full.has_height[v] != 0;
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    for (const VertexId v : corners(t)) {
      if (lone[v] != 0) full.classes[t] = TriangleClass::kVoid;
    }
  }
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    for (const VertexId v : corners(t)) {
      if (full.classes[t] == TriangleClass::kSurface) on_surface[v] = 1;
    }
  }
  for (VertexId v = 0; v < lone.size(); ++v) {
    if (full.has_height[v] != 0 && on_surface[v] == 0) {
      full.vertices[v].height += 1000000;  // of codes: above all others
    }
  }
  return reference::simplify_unmeasured(std::move(full), random);
}

TEST(Highest, ListsAnyNumberOfVerticesOverVoids) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::mt19937_64 random(seed);
    const Hierarchy h = hierarchy_with_lone_samples(random, 40);
    const TemporaryStore file(h);
    const Terrain terrain(file.open());
    HighestRequest request;
    request.region = Window{-1e9, -1e9, 1e9, 1e9};
    for (const std::uint32_t listed : {1, 2, 3, 7, 30, 31, 100, 500, 1000, 1400, 1600, 100000}) {
      for (const bool lowest : {false, true}) {
        request.listed = listed;
        request.lowest = lowest;
        check(highest(terrain, request), request, h.full, h.facts);
      }
    }
  }
}

TEST(Highest, LooksAtEachRecordOnce) {
  std::mt19937_64 random(9);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 90, 90, 4, 0.05), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  request.listed = 8000;
  EXPECT_LE(highest(terrain, request).cost.records_examined, h.records.size());
}

/// That locating one point at the same level of detail reads, by splits: these need all records up
/// to the last vertex of the level.
std::uint64_t pages_of_one_point(const Terrain& terrain, const HighestRequest& request,
                                 MapPoint point) {
  LocateRequest where;
  where.detail.vertices = request.detail.vertices;
  return terrain.locate({&point, 1}, where, AnswerBy::kSplits).cost.io.pages;
}

// Finding the last of the first so many vertices reads most of their pages: more than all else.
TEST(Highest, FindsTheLastVertexOfALevelOfDetailOnce) {
  std::mt19937_64 random(3);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 90, 90, 4, 0.05), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  for (const std::size_t share : {2U, 4U, 8U}) {
    HighestRequest request;
    request.detail.vertices = h.t0.vertices.size() + h.records.size() / share;
    const HighestResult found = highest(terrain, request);
    ASSERT_EQ(found.state, PointState::kSurface);
    const std::uint64_t one = pages_of_one_point(terrain, request, found.point.position);
    EXPECT_GT(one, 20U);
    EXPECT_LT(2 * found.cost.io.pages, 3 * one) << "1/" << share;
  }
}

TEST(Highest, CountsTheVerticesThatItLists) {
  std::mt19937_64 random(9);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 60, 60, 4, 0.0), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  const auto least = [&](std::uint32_t listed) {
    request.listed = listed;
    return reference::least_memory([&](std::uint64_t limit) {
      request.limits.memory_bytes = limit;
      static_cast<void>(highest(terrain, request));
    });
  };
  const std::uint64_t of_one = least(1);
  EXPECT_GE(least(3000), of_one / 2 + 3000 * 48);  // a value, a key, and a node of a tree
  EXPECT_LE(least(3000), of_one * 2 + 3000 * 100);
}

TEST(Highest, OfALargeTerrainReadsFewPagesOfIt) {
  std::mt19937_64 random(5);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 120, 120, 4, 0.0), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  const HighestResult packed = highest(terrain, request);
  EXPECT_EQ(packed.point.height, h.facts.max_height);
  EXPECT_LT(packed.cost.io.pages, 120U * 120U / 64U / 2U);
}

// All of a plain is as high: its south-western vertex, which T0 has, is the first of it.
TEST(Highest, OfAPlainReadsFewPagesOfIt) {
  std::mt19937_64 random(5);
  Tin plain = reference::random_grid(random, 120, 120, 4, 0.0);
  for (auto& v : plain.vertices) v.height = plain.vertices.front().height;
  const Hierarchy h = reference::simplify_unmeasured(std::move(plain), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  for (const std::uint32_t listed : {1U, 5U}) {
    request.listed = listed;
    const HighestResult found = highest(terrain, request);
    const MapPoint corner = h.facts.map.to_map(h.facts.bounds.min_x, h.facts.bounds.min_y);
    EXPECT_EQ(found.point.position.x, corner.x);
    EXPECT_EQ(found.point.position.y, corner.y);
    EXPECT_LT(found.cost.io.pages, 120U * 120U / 64U / 4U) << listed;
  }
}

TEST(Highest, RefusesWhatMeansNothing) {
  const Hierarchy h = reference::random_hierarchy(1);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  HighestRequest request;
  request.listed = 0;
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
  request.listed = 1;
  request.detail.tolerance = -1;
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
  request.detail.tolerance = 1;
  request.detail.vertices = 100;
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
  request.detail.vertices.reset();
  request.region = Window{1, 0, 0, 1};
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
}

}  // namespace
}  // namespace ptin
