// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/raster_tin.h"

#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "tests/construct/test_terrain.h"

namespace ptin {
namespace {

using oracle::kFloat;
using oracle::kInt;

struct Grid {
  std::int32_t width, height;
  std::vector<HeightBits> heights;
  std::vector<std::uint8_t> valid;
};

Grid grid(std::int32_t width, std::vector<int> heights, std::vector<std::uint8_t> valid = {}) {
  Grid g{width, static_cast<std::int32_t>(heights.size()) / width, {}, std::move(valid)};
  for (int h : heights) {
    g.heights.push_back(kInt.bits(h));
  }
  if (g.valid.empty()) {
    g.valid.assign(heights.size(), 1);
  }
  return g;
}

Tin tin_of(const Grid& g, GridPoint origin = {}) {
  return make_raster_tin(g.heights, g.valid, {origin.x, origin.y, g.width, g.height}, kInt);
}

Grid arbitrary_grid(int max_side, int void_percent) {
  Grid g;
  g.width = *rc::gen::inRange(2, max_side);
  g.height = *rc::gen::inRange(2, max_side);
  const auto n = static_cast<std::size_t>(g.width * g.height);
  for (int h : *rc::gen::container<std::vector<int>>(n, rc::gen::inRange(-3, 4))) {
    g.heights.push_back(kInt.bits(h));
  }
  for (int v : *rc::gen::container<std::vector<int>>(n, rc::gen::inRange(0, 100))) {
    g.valid.push_back(v >= void_percent);
  }
  return g;
}

/// I1, I2, I3, I5 and I6 of a mesh, from first principles.
void expect_sound(const Tin& tin, const Grid& g) {
  std::int64_t doubled_area = 0;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& tri = tin.triangles[t];
    const std::int64_t area =
        orient(tin.position(tri.v[0]), tin.position(tri.v[1]), tin.position(tri.v[2]));
    ASSERT_EQ(area, 1) << "triangle " << t;
    doubled_area += area;
    bool surface = true;
    for (int i = 0; i < 3; ++i) {
      surface = surface && tin.has_height[tri.v[i]];
      const TriangleId n = tri.n[i];
      const VertexId from = tri.v[next_corner(i)], to = tri.v[previous_corner(i)];
      if (n == kNone) {
        const GridPoint p = tin.position(from), q = tin.position(to), o = tin.position(0);
        const bool on_side = (p.x == q.x && (p.x == o.x || p.x == o.x + g.width - 1)) ||
                             (p.y == q.y && (p.y == o.y || p.y == o.y + g.height - 1));
        ASSERT_TRUE(on_side) << "triangle " << t << " lacks neighbour " << i;
        continue;
      }
      const Triangle& other = tin.triangles[n];
      const int j = side_of(other, t);
      ASSERT_EQ(other.n[j], t);
      ASSERT_EQ(other.v[next_corner(j)], to);
      ASSERT_EQ(other.v[previous_corner(j)], from);
    }
    ASSERT_EQ(tin.classes[t], surface ? TriangleClass::kSurface : TriangleClass::kVoid);
  }
  ASSERT_EQ(doubled_area, 2 * std::int64_t{g.width - 1} * (g.height - 1));
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const Triangle& tri = tin.triangles[tin.vertices[v].triangle];
    const int i = corner_of(tri, v);
    ASSERT_EQ(tri.v[i], v);
    const GridPoint p = tin.position(v), o = tin.position(0);
    const bool border =
        p.x == o.x || p.y == o.y || p.x == o.x + g.width - 1 || p.y == o.y + g.height - 1;
    // The clockwise neighbour around v lies across the edge from v to v[i + 1], opposite to corner
    // i + 2.
    ASSERT_EQ(tri.n[previous_corner(i)] == kNone, border) << "vertex " << v;
  }
}

TEST(RasterTin, CutsACellAlongTheSmallerHeightDifference) {
  const Tin rising = tin_of(grid(2, {5, 0, 9, 6}), {1, 0});
  EXPECT_EQ(rising.triangles[0].v[2], 3U);  // (a, b, c)
  const Tin falling = tin_of(grid(2, {0, 5, 6, 9}), {0, 0});
  EXPECT_EQ(falling.triangles[0].v[2], 2U);  // (a, b, d)
}

TEST(RasterTin, BreaksTiesByTheParityOfTheGlobalCorner) {
  EXPECT_EQ(tin_of(grid(2, {0, 0, 0, 0}), {6, 4}).triangles[0].v[2], 3U);
  EXPECT_EQ(tin_of(grid(2, {0, 0, 0, 0}), {6, 5}).triangles[0].v[2], 2U);
  const GridPoint far{kGridMax - 1, kGridMax - 1};  // x + y would not fit in 32 bits
  EXPECT_EQ(tin_of(grid(2, {0, 0, 0, 0}), far).triangles[0].v[2], 3U);
}

TEST(RasterTin, ComparesFloatHeightsAsNumbers) {
  Grid g = grid(2, {0, 0, 0, 0});
  const double heights[4] = {-1.5, 0.25, 0.5,
                             -1.25};  // rising differs by 0.25, falling by 0.25: parity decides
  for (int i = 0; i < 4; ++i) {
    g.heights[i] = kFloat.bits(heights[i]);
  }
  EXPECT_EQ(make_raster_tin(g.heights, g.valid, {0, 0, 2, 2}, kFloat).triangles[0].v[2], 3U);
  g.heights[0] = kFloat.bits(-1.75);
  EXPECT_EQ(make_raster_tin(g.heights, g.valid, {0, 0, 2, 2}, kFloat).triangles[0].v[2], 2U);
}

TEST(RasterTin, KeepsThreeCornersOfACellWithOneVoidOnTheSurface) {
  for (int corner = 0; corner < 4; ++corner) {
    Grid g = grid(2, {0, 0, 0, 0});
    g.valid[corner] = 0;
    const Tin tin = tin_of(g);
    EXPECT_NE(tin.classes[0], tin.classes[1]) << "void corner " << corner;
    EXPECT_EQ(tin.has_height[corner], 0);
  }
}

TEST(RasterTin, GivesVerticesWithoutHeightTheHeightBitsZero) {
  const Tin tin = tin_of(grid(2, {7, 7, 7, 7}, {1, 0, 1, 1}));
  EXPECT_EQ(tin.vertices[1].height, 0U);
  EXPECT_EQ(tin.vertices[0].height, kInt.bits(7));
}

TEST(RasterTin, RefusesAWindowBeyondTheGrid) {
  try {
    tin_of(grid(2, {0, 0, 0, 0}), {kGridMax, 0});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(std::string(e.what()).find("2^30"), std::string::npos);
  }
}

TEST(RasterTin, RefusesOneRowOfSamples) {
  Grid g = grid(4, {0, 0, 0, 0});
  EXPECT_THROW(tin_of(g), Error);
}

RC_GTEST_PROP(RasterTin, IsASoundMeshWithEveryCornerRuleOfTheCell, ()) {
  const Grid g = arbitrary_grid(9, *rc::gen::element(0, 20, 60, 100));
  const GridPoint origin{*rc::gen::inRange(0, 4), *rc::gen::inRange(0, 4)};
  const Tin tin = tin_of(g, origin);
  expect_sound(tin, g);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  for (std::int32_t y = 0; y + 1 < g.height; ++y) {
    for (std::int32_t x = 0; x + 1 < g.width; ++x) {
      const int at[4] = {y * g.width + x, y * g.width + x + 1, (y + 1) * g.width + x + 1,
                         (y + 1) * g.width + x};
      RasterCell cell{};
      for (int i = 0; i < 4; ++i) {
        cell.code[i] = kInt.code(g.heights[at[i]]);
        cell.has_height[i] = g.valid[at[i]];
      }
      const bool rising =
          tin.triangles[2 * (y * (g.width - 1) + x)].v[2] == static_cast<VertexId>(at[2]);
      RC_ASSERT(rising == (cell_diagonal(cell, {origin.x + x, origin.y + y}) == Diagonal::kRising));
    }
  }
}

RC_GTEST_PROP(RasterTin, OfATileIsThePartOfTheWhole, ()) {
  const Grid g = arbitrary_grid(12, 25);
  const std::int32_t x0 = *rc::gen::inRange(0, g.width - 1),
                     y0 = *rc::gen::inRange(0, g.height - 1);
  const std::int32_t x1 = *rc::gen::inRange(x0 + 1, g.width),
                     y1 = *rc::gen::inRange(y0 + 1, g.height);
  Grid tile{x1 - x0 + 1, y1 - y0 + 1, {}, {}};
  for (std::int32_t y = y0; y <= y1; ++y) {
    for (std::int32_t x = x0; x <= x1; ++x) {
      tile.heights.push_back(g.heights[y * g.width + x]);
      tile.valid.push_back(g.valid[y * g.width + x]);
    }
  }
  using Corners = std::set<VertexKey>;
  std::map<Corners, TriangleClass> whole;
  const Tin all = tin_of(g), part = tin_of(tile, {x0, y0});
  const auto corners = [](const Tin& tin, TriangleId t) {
    Corners keys;
    for (VertexId v : tin.triangles[t].v) {
      keys.insert(key_of(tin.position(v)));
    }
    return keys;
  };
  for (TriangleId t = 0; t < all.triangles.size(); ++t) {
    whole[corners(all, t)] = all.classes[t];
  }
  for (TriangleId t = 0; t < part.triangles.size(); ++t) {
    const auto found = whole.find(corners(part, t));
    RC_ASSERT(found != whole.end());
    RC_ASSERT(found->second == part.classes[t]);
  }
}

RC_GTEST_PROP(LoneSamples, AreThoseWithHeightThatTouchNoSurfaceTriangle, ()) {
  Grid g = arbitrary_grid(9, *rc::gen::element(0, 30, 60, 80, 100));
  const Tin tin = tin_of(g);
  std::vector<std::uint8_t> touches(g.valid.size(), 0);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (VertexId v : tin.triangles[t].v) {
      touches[v] |= tin.classes[t] == TriangleClass::kSurface;
    }
  }
  std::vector<std::uint64_t> expected;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    if (g.valid[i] && !touches[i]) {
      expected.push_back(i);
    }
  }
  const auto lone = find_lone_samples(g.valid, {0, 0, g.width, g.height});
  RC_ASSERT(lone == expected);
  for (std::uint64_t i : lone) {
    g.valid[i] = 0;
  }
  RC_ASSERT(find_lone_samples(g.valid, {0, 0, g.width, g.height}).empty());
}

}  // namespace
}  // namespace ptin
