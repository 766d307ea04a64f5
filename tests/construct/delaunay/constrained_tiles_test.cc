// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles of points with breaklines: pieces of one constrained Delaunay triangulation.
#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/orient.h"
#include "tests/construct/delaunay/tiled_delaunay.h"
#include "tests/construct/line_sets.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/point_sets.h"

namespace ptin {
namespace {

__extension__ using Int128 = __int128;
using KeyEdge = std::pair<VertexKey, VertexKey>;

/// All lines are level, so they may cross anywhere.
constexpr std::int64_t kHeight = 7;

PointBuckets buckets_with(const std::vector<GridPoint>& points, const SourceLines& lines) {
  std::string text;
  for (const GridPoint p : points) {
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(kHeight) + "\n";
  }
  const MemoryFile file("set.xyz", text);
  SourceOptions options;
  options.lines = &lines;
  return read_buckets({file.path()}, options);
}

/// Positive when d lies inside of the circle of a, b and c, which turn left.
int side_of_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const auto row = [&](GridPoint p) {
    const Int128 x = p.x - d.x, y = p.y - d.y;
    return std::array<Int128, 3>{x, y, x * x + y * y};
  };
  const auto r = row(a), s = row(b), t = row(c);
  const Int128 det = r[0] * (s[1] * t[2] - s[2] * t[1]) - r[1] * (s[0] * t[2] - s[2] * t[0]) +
                     r[2] * (s[0] * t[1] - s[1] * t[0]);
  return det > 0 ? 1 : (det < 0 ? -1 : 0);
}

bool is_between(GridPoint a, GridPoint b, GridPoint p) {
  return orient(a, b, p) == 0 && contains(united(box_of(a), b), p);
}

/// Edges of triangles with the corners beyond them on either side.
std::map<KeyEdge, std::vector<GridPoint>> edges_of(const std::vector<KeyTriangle>& triangles) {
  std::map<KeyEdge, std::vector<GridPoint>> edges;
  for (const KeyTriangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      const VertexKey p = t[(i + 1) % 3], q = t[(i + 2) % 3];
      edges[{std::min(p, q), std::max(p, q)}].push_back(point_of(t[i]));
    }
  }
  return edges;
}

/// Holds triangles against what a constrained Delaunay triangulation is, by brute force: they cover
/// the hull once, every point is a vertex, every fixed edge is a chain of edges, and every other
/// edge is Delaunay with the two triangles beside it, where of four points on a circle the last by x,
/// then y, is cut off.
void expect_constrained_delaunay(const PointBuckets& buckets,
                                 const std::vector<KeyTriangle>& triangles) {
  std::vector<BucketPoint> points;
  buckets.take(0, buckets.size(), points);
  Int128 area = 0;
  std::set<VertexKey> used;
  for (const KeyTriangle& t : triangles) {
    const std::int64_t twice = orient(point_of(t[0]), point_of(t[1]), point_of(t[2]));
    ASSERT_GT(twice, 0);
    area += twice;
    used.insert(t.begin(), t.end());
  }
  Int128 hull = 0;
  const auto& corners = buckets.hull().corners();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    hull += orient(corners[0], corners[i - 1], corners[i]);
  }
  EXPECT_TRUE(area == hull);
  EXPECT_EQ(used.size(), points.size());
  const auto edges = edges_of(triangles);
  std::set<KeyEdge> fixed;
  for (const LineEdge& e : buckets.fixed_edges().edges()) {
    const GridPoint a = buckets.fixed_edges().vertices()[e.a].position;
    const GridPoint b = buckets.fixed_edges().vertices()[e.b].position;
    std::vector<VertexKey> chain;
    for (const BucketPoint& p : points) {
      if (is_between(a, b, p.position)) {
        chain.push_back(key_of(p.position));
      }
    }
    std::sort(chain.begin(), chain.end());  // by y, then x: in order along any line
    for (std::size_t i = 1; i < chain.size(); ++i) {
      EXPECT_TRUE(edges.contains({chain[i - 1], chain[i]}));
      fixed.insert({chain[i - 1], chain[i]});
    }
  }
  for (const auto& [edge, beyond] : edges) {
    ASSERT_LE(beyond.size(), 2U);
    if (beyond.size() < 2 || fixed.contains(edge)) {
      continue;
    }
    GridPoint a = point_of(edge.first), b = point_of(edge.second);
    if (orient(a, b, beyond[0]) < 0) {
      std::swap(a, b);
    }
    const int inside = side_of_circle(a, b, beyond[0], beyond[1]);
    EXPECT_LE(inside, 0);
    if (inside == 0) {
      const std::array<GridPoint, 4> four{a, b, beyond[0], beyond[1]};
      const GridPoint last = *std::max_element(four.begin(), four.end(), [](auto p, auto q) {
        return p.x != q.x ? p.x < q.x : p.y < q.y;
      });
      EXPECT_TRUE(!(last == a) && !(last == b));
    }
  }
}

void expect_tiles_agree(const PointBuckets& buckets, const std::vector<std::uint64_t>& tiles) {
  std::vector<KeyTriangle> one = tiled(buckets, 1);
  std::sort(one.begin(), one.end());
  expect_constrained_delaunay(buckets, one);
  for (const std::uint64_t n : tiles) {
    std::vector<KeyTriangle> parts = tiled(buckets, n);
    std::sort(parts.begin(), parts.end());
    ASSERT_EQ(parts.size(), one.size()) << n << " tiles";
    ASSERT_TRUE(parts == one) << n << " tiles";
  }
}

/// Random lines over a square, long ones and short ones; some go along rows and columns.
std::vector<TestLine> random_lines(std::mt19937_64& random, std::int64_t side, int count) {
  const auto up_to = [&](std::int64_t most) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most + 1));
  };
  std::vector<TestLine> lines;
  for (int i = 0; i < count; ++i) {
    TestLine line;
    std::int64_t x = up_to(side), y = up_to(side);
    for (std::int64_t k = up_to(4) + 2; k > 0; --k) {
      line.push_back({x, y, kHeight});
      const std::int64_t reach = i % 3 == 0 ? side : side / 4 + 1;
      x = i % 4 == 1 ? x : std::clamp<std::int64_t>(x + up_to(2 * reach) - reach, 0, side);
      y = i % 4 == 2 ? y : std::clamp<std::int64_t>(y + up_to(2 * reach) - reach, 0, side);
    }
    lines.push_back(line);
  }
  return lines;
}

class EveryKindWithLines : public testing::TestWithParam<PointKind> {};

TEST_P(EveryKindWithLines, TilesAreOneConstrainedTriangulation) {
  const std::vector<GridPoint> points = points_of(GetParam(), 1500, 5);
  std::int64_t side = 0;
  for (const GridPoint p : points) {
    side = std::max({side, std::int64_t{p.x}, std::int64_t{p.y}});
  }
  std::mt19937_64 random(11);
  const SourceLines lines = lines_of(random_lines(random, side, 12));
  expect_tiles_agree(buckets_with(points, lines), {2, 7, 32});
}

INSTANTIATE_TEST_SUITE_P(ConstrainedTiles, EveryKindWithLines, testing::ValuesIn(kPointKinds),
                         [](const auto& kind) { return name_of(kind.param); });

RC_GTEST_PROP(ConstrainedTiles, AreOneTriangulationOnGridsWhereAllIsCocircular, ()) {
  const auto side = *rc::gen::inRange<std::int64_t>(2, 12);
  std::mt19937_64 random(*rc::gen::inRange<std::uint64_t>(0, 1U << 30));
  std::vector<GridPoint> points;
  for (std::int32_t y = 0; y <= side; ++y) {
    for (std::int32_t x = 0; x <= side; ++x) {
      if (random() % 5 != 0) {
        points.push_back({x, y});
      }
    }
  }
  points.push_back({0, 0});
  points.push_back({static_cast<std::int32_t>(side), 0});
  points.push_back({0, static_cast<std::int32_t>(side)});
  const int count = *rc::gen::inRange(1, 8);
  const SourceLines lines = lines_of(random_lines(random, side, count));
  expect_tiles_agree(buckets_with(points, lines), {2, 5, 13});
}

RC_GTEST_PROP(ConstrainedTiles, AreOneTriangulationWhereLinesReachFarBeyondThePoints, ()) {
  std::mt19937_64 random(*rc::gen::inRange<std::uint64_t>(0, 1U << 30));
  const auto n = *rc::gen::inRange<std::uint64_t>(3, 200);
  std::vector<TestLine> far = random_lines(random, 3000, 6);
  far.push_back({{0, 0, kHeight}, {2900, 1700, kHeight}});  // from among the points
  const SourceLines lines = lines_of(far);
  expect_tiles_agree(buckets_with(points_of(PointKind::kEven, n, n), lines), {2, 9, 40});
}

}  // namespace
}  // namespace ptin
