// SPDX-License-Identifier: GPL-3.0-or-later
//
// Highest and lowest points of random windows against all triangles of the full TIN.
#include "engine/query/highest.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "storage/spatialindex_rtree.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::TemporaryStore;

struct Brute {
  double most = -INFINITY;       ///< Of the surface in the window.
  std::vector<double> vertices;  ///< Falling.
  bool domain = false;           ///< Some triangle, void or not, meets the window.
};

/// The largest value of a linear function on a triangle within a rectangle lies at a corner, at a
/// corner of the rectangle, or where their sides cross: all are tried.
Brute brute_force(const Hierarchy& h, const Window& w, double sign) {
  Brute b;
  std::vector<std::uint8_t> seen(h.full.vertices.size());
  const auto inside = [&](MapPoint p) {
    return w.min_x <= p.x && p.x <= w.max_x && w.min_y <= p.y && p.y <= w.max_y;
  };
  for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
    const bool surface = h.full.classes[t] == TriangleClass::kSurface;
    const auto reach = [&](double value) {
      b.domain = true;
      if (surface) b.most = std::max(b.most, value);
    };
    MapPoint p[3];
    double z[3];
    for (int i = 0; i < 3; ++i) {
      const VertexId v = h.full.triangles[t].v[i];
      p[i] = h.facts.map.to_map(h.full.position(v).x, h.full.position(v).y);
      z[i] = sign * h.facts.heights.height(h.full.vertices[v].height);
      if (inside(p[i])) {
        reach(z[i]);
        if (surface && seen[v] == 0) b.vertices.push_back(z[i]);
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
  std::sort(b.vertices.begin(), b.vertices.end(), std::greater<>());
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

RC_GTEST_PROP(Highest, IsThatOfAllTriangles, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const ProgressiveTin terrain(file.open());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 8; ++i) {
    HighestRequest request;
    request.window = window_in(random, h.facts);
    request.lowest = random() % 2 == 0;
    request.vertices = 1 + static_cast<std::uint32_t>(random() % 5);
    const double sign = request.lowest ? -1.0 : 1.0;
    const Brute wanted = brute_force(h, *request.window, sign);
    const HighestResult got = highest(terrain, request);
    if (std::isinf(wanted.most)) {
      RC_ASSERT(got.state ==
                (wanted.domain ? HighestResult::State::kVoid : HighestResult::State::kOutside));
      RC_ASSERT(got.vertices.empty());
      continue;
    }
    RC_ASSERT(got.height_min <= got.point.height);
    RC_ASSERT(got.point.height <= got.height_max);
    RC_ASSERT(got.state == HighestResult::State::kSurface);
    RC_ASSERT(std::abs(sign * got.point.height - wanted.most) <= 1e-9);
    const MapPoint p = got.point.position;
    const Window& w = *request.window;
    RC_ASSERT((w.min_x - 1e-9 <= p.x && p.x <= w.max_x + 1e-9));
    RC_ASSERT((w.min_y - 1e-9 <= p.y && p.y <= w.max_y + 1e-9));
    RC_ASSERT(got.vertices.size() ==
              std::min<std::size_t>(request.vertices, wanted.vertices.size()));
    for (std::size_t k = 0; k < got.vertices.size(); ++k) {
      RC_ASSERT(sign * got.vertices[k].height == wanted.vertices[k]);
    }
    if (got.at_vertex) RC_ASSERT(got.point.height == got.vertices.front().height);
  }
}

TEST(Highest, OfALargeTerrainReadsFewPagesOfIt) {
  std::mt19937_64 random(5);
  reference::Options options;
  options.measured = false;
  const Hierarchy h =
      reference::simplify(reference::random_grid(random, 120, 120, 4, 0.0), random, options);
  const TemporaryStore file(h);
  const auto store = file.open();
  ProgressiveTin terrain(store);
  HighestRequest request;
  const HighestResult packed = highest(terrain, request);
  EXPECT_EQ(packed.point.height, h.facts.max_height);
  EXPECT_LT(packed.cost.io.pages, 120U * 120U / 64U / 2U);
  SpatialIndexOptions index;
  terrain.use_index(SpatialIndexRTree::open(store, index));
  const HighestResult other = highest(terrain, request);
  EXPECT_EQ(other.point.height, packed.point.height);
}

TEST(Highest, RefusesWhatMeansNothing) {
  const Hierarchy h = reference::random_hierarchy(1);
  const TemporaryStore file(h);
  const ProgressiveTin terrain(file.open());
  HighestRequest request;
  request.vertices = 0;
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
  request.vertices = 1;
  request.window = Window{1, 0, 0, 1};
  EXPECT_THROW(static_cast<void>(highest(terrain, request)), Error);
}

}  // namespace
}  // namespace ptin
