// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/validate.h"
#include "tests/construct/delaunay_tin.h"

namespace ptin {
namespace {

__extension__ using Int128 = __int128;

/// Sign of d against the circle of the counter-clockwise a, b, c: +1 inside, 0 on it, -1 outside.
/// Exact: differences are at most 2^30, squared lengths 2^61, minors 2^61, their products 2^122,
/// three of them below 2^124.
int in_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const auto row = [&](GridPoint p) {
    const Int128 x = Int128{p.x} - d.x, y = Int128{p.y} - d.y;
    return std::array<Int128, 3>{x, y, x * x + y * y};
  };
  const auto [ax, ay, al] = row(a);
  const auto [bx, by, bl] = row(b);
  const auto [cx, cy, cl] = row(c);
  const Int128 det = al * (bx * cy - by * cx) - bl * (ax * cy - ay * cx) + cl * (ax * by - ay * bx);
  return det > 0 ? 1 : (det < 0 ? -1 : 0);
}

/// The documented rule for points on the circle: the last one by (x, y) counts as outside of the
/// circle of the other three; seen from another one, that turns the side of the edge opposite to
/// the last one.
bool counts_as_inside(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const int exact = in_circle(a, b, c, d);
  if (exact != 0) {
    return exact > 0;
  }
  const auto last = std::max({a, b, c, d}, [](GridPoint p, GridPoint q) {
    return std::tie(p.x, p.y) < std::tie(q.x, q.y);
  });
  if (last == d) {
    return false;
  }
  // The ear of the last one is a triangle of the four, so its circle does not hold the fourth: that
  // is the case where d lies beyond the edge opposite to the last one.
  const std::array<GridPoint, 3> corners{a, b, c};
  for (int i = 0; i < 3; ++i) {
    if (corners[i] == last) {
      return orient(corners[(i + 1) % 3], corners[(i + 2) % 3], d) > 0;
    }
  }
  return false;
}

using Points = std::vector<GridPoint>;

Points sorted(Points points) {
  std::sort(points.begin(), points.end(),
            [](GridPoint p, GridPoint q) { return key_of(p) < key_of(q); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Tin delaunay(const Points& points) {
  std::vector<HeightBits> heights(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    heights[i] = static_cast<HeightBits>(i * 7);
  }
  return make_delaunay_tin(points, heights);
}

bool all_collinear(const Points& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](GridPoint p) { return orient(points.front(), points.back(), p) == 0; });
}

/// Random points on a small square (many on one circle or line) or on the whole grid.
Points arbitrary_points() {
  const std::int32_t side = *rc::gen::element(3, 6, 40, kGridMax);
  const auto n = *rc::gen::inRange<std::size_t>(3, 60);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    // inRange() grows with the size parameter; the whole range is wanted at every size.
    const auto coordinate = [&] {
      return static_cast<std::int32_t>(*rc::gen::arbitrary<std::uint32_t>() *
                                       std::uint64_t{2654435761U} % (std::uint64_t(side) + 1));
    };
    points.push_back({coordinate(), coordinate()});
  }
  return sorted(points);
}

void expect_points_refused(const Points& points, const std::string& word) {
  try {
    delaunay(points);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  }
}

TEST(Delaunay, OfThreePointsIsOneTriangle) {
  const Tin tin = delaunay({{0, 0}, {5, 0}, {2, 3}});
  ASSERT_EQ(tin.triangles.size(), 1U);
  EXPECT_EQ(tin.triangles[0].v[0], 0U);
  EXPECT_EQ(tin.triangles[0].v[1], 1U);
  EXPECT_EQ(tin.vertices[2].height, 14U);
  EXPECT_EQ(validate(tin), "");
}

TEST(Delaunay, CutsASquareAlongItsFallingDiagonal) {
  const Tin tin = delaunay({{0, 0}, {1, 0}, {0, 1}, {1, 1}});
  ASSERT_EQ(tin.triangles.size(), 2U);
  EXPECT_EQ(tin.triangles[0].v[2], 2U);  // (0, 1, 2): its third corner is the upper left
}

TEST(Delaunay, KeepsCollinearPointsOfTheHullAsBorderVertices) {
  Points points;
  for (std::int32_t y = 0; y <= 4; ++y) {
    for (std::int32_t x = 0; x <= 6; ++x) {
      points.push_back({x, y});
    }
  }
  const Tin tin = delaunay(points);
  EXPECT_EQ(validate(tin), "");
  EXPECT_EQ(twice_area(tin), 2 * 24);
  EXPECT_EQ(tin.triangles.size(), 48U);
}

TEST(Delaunay, HoldsTheCornersOfTheWholeGrid) {
  const Tin tin = delaunay(sorted({{0, 0},
                                   {kGridMax, 0},
                                   {0, kGridMax},
                                   {kGridMax, kGridMax},
                                   {kGridMax - 1, kGridMax - 1},
                                   {1, 1},
                                   {kGridMax / 2, 3}}));
  EXPECT_EQ(validate(tin), "");
  EXPECT_EQ(twice_area(tin), std::int64_t{1} << 61);
}

TEST(Delaunay, RefusesWhatSpansNoTriangle) {
  expect_points_refused({}, "fewer than 3");
  expect_points_refused({{0, 0}, {1, 1}}, "fewer than 3");
  expect_points_refused({{0, 0}, {1, 1}, {2, 2}, {kGridMax, kGridMax}}, "collinear");
}

TEST(Delaunay, RefusesPointsOutOfOrderOrTwice) {
  expect_points_refused({{0, 0}, {0, 0}, {1, 1}}, "sorted");
  expect_points_refused({{0, 1}, {0, 0}, {1, 1}}, "sorted");
  expect_points_refused({{0, 0}, {-1, 1}, {1, 1}}, "outside of the grid");
}

TEST(Delaunay, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const Points points{{0, 0}, {5, 0}, {2, 3}};
  const std::vector<HeightBits> heights(3);
  try {
    std::ignore = make_delaunay_tin(points, heights, stop.get_token());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

/// A triangulation whose every edge passes the perturbed test is the only one that does: so this
/// shows that ties do not depend on the order of insertion, of tiles or of anything but the points.
RC_GTEST_PROP(Delaunay, PassesThePerturbedCircleTestAcrossEveryEdge, ()) {
  const Points points = arbitrary_points();
  RC_PRE(points.size() >= 3U);
  RC_PRE(!all_collinear(points));
  const Tin tin = delaunay(points);
  RC_ASSERT(validate(tin) == "");
  for (const Triangle& t : tin.triangles) {
    for (int i = 0; i < 3; ++i) {
      if (t.n[i] == kNone) {
        continue;
      }
      const Triangle& other = tin.triangles[t.n[i]];
      const VertexId apex =
          other.v[side_of(other, static_cast<TriangleId>(&t - tin.triangles.data()))];
      RC_ASSERT(!counts_as_inside(points[t.v[0]], points[t.v[1]], points[t.v[2]], points[apex]));
    }
  }
}

RC_GTEST_PROP(Delaunay, IsExactlyTheTrianglesWithoutAPointInside, ()) {
  Points points = arbitrary_points();
  points.resize(std::min<std::size_t>(points.size(), 14));
  RC_PRE(points.size() >= 3U);
  RC_PRE(!all_collinear(points));
  const Tin tin = delaunay(points);
  std::set<std::array<VertexId, 3>> found;
  for (const Triangle& t : tin.triangles) {
    RC_ASSERT(t.v[0] < t.v[1]);
    RC_ASSERT(t.v[0] < t.v[2]);
    found.insert({t.v[0], t.v[1], t.v[2]});
  }
  const auto n = static_cast<VertexId>(points.size());
  std::set<std::array<VertexId, 3>> expected;
  for (VertexId a = 0; a < n; ++a) {
    for (VertexId b = a + 1; b < n; ++b) {
      for (VertexId c = a + 1; c < n; ++c) {
        if (orient(points[a], points[b], points[c]) <= 0) {
          continue;
        }
        bool empty = true;
        for (VertexId d = 0; d < n && empty; ++d) {
          empty = d == a || d == b || d == c ||
                  !counts_as_inside(points[a], points[b], points[c], points[d]);
        }
        if (empty) {
          expected.insert({a, b, c});
        }
      }
    }
  }
  RC_ASSERT(found == expected);
}

}  // namespace
}  // namespace ptin
