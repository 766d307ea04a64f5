// SPDX-License-Identifier: GPL-3.0-or-later
//
// A boundary without heights: the terrain inside is that of the points alone, and there is none
// outside.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "storage/verify.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;
using Ring = std::vector<std::array<double, 2>>;

constexpr double kExtent = 400.0;

/// Rough hills, without a point in a square pond and a long gap.
std::string made_points() {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> at(0.0, kExtent);
  std::string text = "x y z\n";
  for (int i = 0; i < 1500; ++i) {
    const double x = std::round(at(random)), y = std::round(at(random));
    const bool in_gap = x > 250 && x < 310 && y > 100;
    const double z = std::round(300 + 40 * std::sin(x / 50) + 30 * std::cos(y / 35) + x / 4);
    if (!in_gap)
      text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }
  return text;
}

/// Part of it outside of the points, a hole, a side along a row of the grid.
std::vector<Ring> made_rings() {
  return {{{60.5, 40}, {500, 90}, {330, 370.25}, {200, 300}, {-20, 390}, {60.5, 40}},
          {{150, 150}, {200, 150}, {190, 210}, {150, 150}}};
}

std::string wkt_of(const std::vector<Ring>& rings) {
  std::string text = "id,WKT\n1,\"POLYGON (";
  for (std::size_t i = 0; i < rings.size(); ++i) {
    text += i > 0 ? ",(" : "(";
    for (std::size_t k = 0; k < rings[i].size(); ++k) {
      text += (k > 0 ? "," : "") + std::to_string(rings[i][k][0]) + " " +
              std::to_string(rings[i][k][1]);
    }
    text += ")";
  }
  return text + ")\"\n";
}

bool is_inside(const std::vector<Ring>& rings, double x, double y) {
  bool inside = false;
  for (const Ring& ring : rings) {
    for (std::size_t k = 1; k < ring.size(); ++k) {
      const auto [ax, ay] = ring[k - 1];
      const auto [bx, by] = ring[k];
      if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) inside = !inside;
    }
  }
  return inside;
}

double distance(const std::vector<Ring>& rings, double x, double y) {
  double least = kExtent;
  for (const Ring& ring : rings) {
    for (std::size_t k = 1; k < ring.size(); ++k) {
      const double dx = ring[k][0] - ring[k - 1][0], dy = ring[k][1] - ring[k - 1][1];
      const double px = x - ring[k - 1][0], py = y - ring[k - 1][1];
      const double t = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
      least = std::min(least, std::hypot(px - t * dx, py - t * dy));
    }
  }
  return least;
}

class DrapedBoundary : public testing::Test {
 protected:
  DrapedBoundary() {
    oracle::write_text(folder_.file("points.xyz"), made_points());
    oracle::write_text(folder_.file("area.csv"), wkt_of(made_rings()));
  }
  [[nodiscard]] Terrain built(BuildOptions options, bool bounded, unsigned threads = 1) const {
    if (bounded) options.boundary = folder_.file("area.csv");
    BuildResources resources;
    resources.threads = threads;
    const std::string path = folder_.file(std::to_string(count_++) + ".ptin");
    build({folder_.file("points.xyz")}, path, options, resources);
    return Terrain::open(path);
  }
  /// Both are surface, and equally high, or the bounded one is none where the boundary says so.
  void expect_cut(const Terrain& whole, const Terrain& cut) const {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> at(-10.0, kExtent + 10);
    std::vector<MapPoint> points;
    for (int i = 0; i < 4000; ++i) points.push_back({at(random), at(random)});
    const LocateResult before = whole.locate(points, {}), after = cut.locate(points, {});
    int inside = 0, outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [x, y] = points[i];
      if (distance(made_rings(), x, y) < 1.5) continue;
      const bool wanted =
          before.points[i].state == PointState::kSurface && is_inside(made_rings(), x, y);
      ASSERT_EQ(after.points[i].state == PointState::kSurface, wanted) << x << " " << y;
      (wanted ? inside : outside) += 1;
      // Beside the boundary, rounding to the grid and other diagonals may tell.
      if (wanted && distance(made_rings(), x, y) > 60) {
        EXPECT_NEAR(after.points[i].height, before.points[i].height, 1e-6) << x << " " << y;
      }
    }
    EXPECT_GT(inside, 500);
    EXPECT_GT(outside, 500);
  }

 private:
  ScratchFolder folder_;
  mutable int count_ = 0;
};

TEST_F(DrapedBoundary, CutsTheTerrainOfThePoints) { expect_cut(built({}, false), built({}, true)); }

TEST_F(DrapedBoundary, MakesNoSurfaceOverAGap) {
  BuildOptions options;
  options.max_edge = 40.0;
  expect_cut(built(options, false), built(options, true));
}

TEST_F(DrapedBoundary, LiesOnTheSurface) {
  const Terrain whole = built({}, false), cut = built({}, true);
  const RefinedTin full = cut.refine({});
  ASSERT_EQ(validate(full.tin), "");
  const StoreFacts& facts = cut.store().facts();
  int checked = 0;
  for (const Vertex& v : full.tin.vertices) {
    const MapPoint p = facts.map.to_map(v.position.x, v.position.y);
    if (distance(made_rings(), p.x, p.y) > 0.02) continue;
    const LocateResult on = whole.locate(std::array{p}, {});
    if (on.points[0].state != PointState::kSurface) continue;
    // Half a step of the heights, and what hills rise over a hundredth of a metre.
    EXPECT_NEAR(facts.heights.height(v.height), on.points[0].height, 0.55) << p.x << " " << p.y;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST_F(DrapedBoundary, DoesNotDependOnTilesOrThreads) {
  BuildOptions small;
  small.tile = 6;
  const Terrain one = built({}, true), many = built(small, true, 2);
  EXPECT_GT(many.store().record_count(), 0U);
  EXPECT_TRUE(oracle::named_triangles(one.refine({}).tin) ==
              oracle::named_triangles(many.refine({}).tin));
}

/// Whole metres, so that gaps, crossings and corners often round to one place.
TEST(DrapedBoundaryOnACoarseGrid, TellsInsideFromOutsideWithBreaklinesAndGaps) {
  int built = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<int> at(0, 40);
    std::uniform_real_distribution<double> over(-8.0, 48.0);
    const ScratchFolder folder;
    std::string points = "x y z\n";
    for (int i = 0; i < 150; ++i) {
      points += std::to_string(at(random)) + " " + std::to_string(at(random)) + " 7\n";
    }
    oracle::write_text(folder.file("points.xyz"), points);
    Ring ring;
    for (int i = 0; i < 4; ++i) ring.push_back({over(random), over(random)});
    ring.push_back(ring.front());
    oracle::write_text(folder.file("area.csv"), wkt_of({ring}));
    oracle::write_text(
        folder.file("lines.csv"),
        "id,WKT\n1,\"LINESTRING Z (3 5 7,35 " + std::to_string(at(random)) + " 7,20 38 7)\"\n");
    BuildOptions options;
    options.max_edge = 6.0;
    options.resolution = 1.0;
    options.breaklines = {folder.file("lines.csv")};
    options.boundary = folder.file("area.csv");
    try {
      build({folder.file("points.xyz")}, folder.file("t.ptin"), options, {});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();  // too few points inside
      continue;
    }
    ++built;
    const Terrain terrain = Terrain::open(folder.file("t.ptin"));
    const RefinedTin full = terrain.refine({});
    ASSERT_EQ(validate(full.tin), "");
    const AffineMap& map = terrain.store().facts().map;
    for (TriangleId t = 0; t < full.tin.triangles.size(); ++t) {
      if (full.tin.classes[t] == TriangleClass::kVoid) continue;
      MapPoint corners[3];
      for (int i = 0; i < 3; ++i) {
        const GridPoint p = full.tin.position(full.tin.triangles[t].v[i]);
        corners[i] = map.to_map(p.x, p.y);
      }
      for (int i = 0; i < 3; ++i) {  // near each corner too: no triangle reaches across
        const double x =
            0.9 * corners[i].x + 0.05 * (corners[(i + 1) % 3].x + corners[(i + 2) % 3].x);
        const double y =
            0.9 * corners[i].y + 0.05 * (corners[(i + 1) % 3].y + corners[(i + 2) % 3].y);
        if (distance({ring}, x, y) > 1.5) {
          EXPECT_TRUE(is_inside({ring}, x, y)) << x << " " << y;
        }
      }
    }
  }
  EXPECT_GT(built, 15);
}

}  // namespace
}  // namespace ptin
