// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gap along an edge against every edge of the full TIN, in rationals.
#include "engine/construct/raster/raster_surface.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/construct/exact_oracle.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"

namespace ptin {
namespace {

using oracle::Bound;
using oracle::Corner;
using oracle::Gap;
using oracle::TestTerrain;

struct TrueGap {
  long double beside_surface = 0.0L;   ///< Largest at crossings with edges of surface triangles.
  long double between_heights = 0.0L;  ///< Largest at crossings with edges between two heights.
};

/// Looks at all edges of the full TIN; exact gaps beside surface must not exceed `bound`.
TrueGap true_gap(const TestTerrain& terrain, const Corner& a, const Corner& b, double bound) {
  const Tin& tin = terrain.full;
  const Bound exact(bound, 1.0);
  TrueGap found;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const oracle::Corners c = oracle::corners_of(tin, t, terrain.tile.units.heights);
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId p = tin.triangles[t].v[i], q = tin.triangles[t].v[(i + 1) % 3];
      const bool heights = tin.has_height[p] != 0 && tin.has_height[q] != 0;
      const auto gap = heights ? Gap::of_crossing(a, b, c[i], c[(i + 1) % 3]) : std::nullopt;
      if (!gap) {
        continue;
      }
      found.between_heights = std::max(found.between_heights, gap->rough());
      if (oracle::is_surface(tin, t)) {
        found.beside_surface = std::max(found.beside_surface, gap->rough());
        EXPECT_FALSE(gap->exceeds(exact)) << terrain.name << ": " << gap->rough() << " > " << bound;
      }
    }
  }
  return found;
}

void expect_gaps(const TestTerrain& terrain, int edges, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const HeightEncoding& heights = terrain.tile.units.heights;
  long double largest_code = 1.0L;
  for (const auto& s : terrain.samples) {
    largest_code = std::max(largest_code, std::abs(static_cast<long double>(s.code)));
  }
  for (int i = 0; i < edges; ++i) {
    const auto a = static_cast<VertexId>(random() % terrain.full.vertices.size());
    const auto b = static_cast<VertexId>(random() % terrain.full.vertices.size());
    if (a == b || terrain.full.has_height[a] == 0 || terrain.full.has_height[b] == 0) {
      continue;
    }
    const auto corner = [&](VertexId v) {
      return Corner{terrain.full.position(v), heights.code(terrain.full.vertices[v].height)};
    };
    const double gap = terrain.surface->largest_gap({corner(a).position, corner(a).code},
                                                    {corner(b).position, corner(b).code});
    const TrueGap is = true_gap(terrain, corner(a), corner(b), gap);
    EXPECT_LE(gap, is.between_heights * (1 + 1e-9L) + 1e-13L * largest_code) << terrain.name;
  }
}

TEST(RasterSurface, BoundsTheGapOfAnyEdge) {
  for (const auto& make : oracle::nasty_rasters()) {
    expect_gaps(make(), 60, 1);
  }
}

TEST(TinSurface, BoundsTheGapOfAnyEdge) {
  for (const auto& make : oracle::nasty_points()) {
    expect_gaps(make(), 40, 2);
  }
}

RC_GTEST_PROP(FullSurface, BoundsTheGapOfAnyEdgeOfRandomTerrains, (std::uint64_t seed)) {
  expect_gaps(oracle::random_terrain(seed, 100), 10, seed);
}

TEST(FullSurface, FindsNoGapWhereAllHeightsAreEqual) {
  const auto seven = [](int, int) { return 7.1; };
  const TestTerrain raster =
      oracle::make_raster({"flat", 20, 20, seven, {}, {HeightType::float32, 1.0, 0.0}, {}, 0.1});
  std::vector<GridPoint> grid;
  for (int i = 0; i < 400; ++i) {
    grid.push_back({i % 20 * 3, i / 20 * 7});
  }
  const TestTerrain points = oracle::make_points(
      {"flat points", grid, [](GridPoint) { return 7.1; }, {HeightType::float32, 1.0, 0.0}});
  for (const TestTerrain* terrain : {&raster, &points}) {
    for (VertexId b = 1; b < terrain->full.vertices.size(); ++b) {
      const double code = terrain->tile.units.heights.code(terrain->full.vertices[0].height);
      EXPECT_EQ(terrain->surface->largest_gap({terrain->full.position(0), code},
                                              {terrain->full.position(b), code}),
                0.0);
    }
  }
}

TEST(RasterSurface, SkipsCrossingsInVoids) {
  // A wall of 100 with a void behind each of its samples: only what lies between heights counts.
  const auto code = [](int x, int) { return x == 3 ? 100.0 : 0.0; };
  const auto valid = [](int x, int y) { return y == 0 || y == 6 || x < 3; };
  const TestTerrain terrain =
      oracle::make_raster({"wall", 7, 7, code, valid, {HeightType::int32, 1.0, 0.0}, {}, 0.1});
  const auto end = [&](VertexId v) { return EdgeEnd{terrain.full.position(v), 0.0}; };
  EXPECT_EQ(terrain.surface->largest_gap(end(0), end(6 * 7)), 0.0);        // x = 0, all of it data
  EXPECT_NEAR(terrain.surface->largest_gap(end(0), end(6)), 100.0, 1e-9);  // y = 0, over the wall
  EXPECT_NEAR(terrain.surface->largest_gap(end(1 * 7), end(6)), 40.0, 1e-9);  // leaves the data
}

/// A window of a raster with voids that has no border in reach: an edge of the border through it has
/// moved by nobody knows how much.
TEST(RasterSurface, FarFromAnyBorderLetsNoBorderThrough) {
  RasterSurface surface(std::vector<HeightBits>(30, 0), std::vector<std::uint8_t>(30, 1),
                        {100, 200, 6, 5}, oracle::kInt);  // from (100, 200) to (105, 204)
  EXPECT_EQ(surface.border_move({90, 201}, {110, 203}), 0.0) << "there are no voids";
  surface.set_far_from_border();
  for (const auto& [a, b] : {std::pair(GridPoint{90, 201}, GridPoint{110, 203}),
                             {{102, 202}, {130, 260}},
                             {{100, 200}, {105, 204}},
                             {{101, 190}, {101, 201}}}) {
    EXPECT_EQ(surface.border_move(a, b), std::numeric_limits<double>::infinity());
    EXPECT_EQ(surface.border_move(b, a), std::numeric_limits<double>::infinity());
  }
  for (const auto& [a, b] : {std::pair(GridPoint{90, 200}, GridPoint{110, 200}),  // along its sides
                             {{105, 190}, {105, 300}},
                             {{100, 201}, {100, 203}},
                             {{90, 210}, {110, 205}},  // beside it
                             {{99, 201}, {101, 199}},  // through a corner
                             {{106, 200}, {109, 204}}}) {
    EXPECT_EQ(surface.border_move(a, b), 0.0) << a.x << " " << a.y << " to " << b.x << " " << b.y;
    EXPECT_EQ(surface.border_move(b, a), 0.0);
  }
}

}  // namespace
}  // namespace ptin
