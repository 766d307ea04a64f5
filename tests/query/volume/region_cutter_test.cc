// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regions that are hard to cut at: the areas that come out, and that any come out at all.
#include "engine/query/volume/region_cutter.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"

namespace ptin {
namespace {

double area_of(const std::vector<ConvexPiece>& parts) {
  double twice = 0.0;
  for (const ConvexPiece& part : parts) {
    const auto c = part.corners();
    for (std::size_t i = 0; i < c.size(); ++i) {
      const MapPoint a = c[i], b = c[(i + 1) % c.size()];
      twice += a.x * b.y - a.y * b.x;
    }
  }
  return twice / 2;
}

double cut_area(const Polygon& polygon, double side) {
  const RegionCutter cutter(polygon, AffineMap{});
  std::vector<ConvexPiece> parts;
  cutter.cut(ConvexPiece({{0, 0}, {side, 0}, {0, side}}), parts);
  return area_of(parts);
}

/// Each of its edges spans all of the polygon's height.
TEST(RegionCutter, TakesAZigzagOfManyEdgesOverItsWholeHeight) {
  constexpr int kTeeth = 70'000;
  Polygon polygon;
  polygon.rings.emplace_back();
  for (int i = 0; i <= kTeeth; ++i) {
    polygon.rings[0].push_back({i * 0.01, i % 2 == 0 ? 0.0 : 1000.0});
  }
  polygon.rings[0].push_back({kTeeth * 0.01, -1.0});
  polygon.rings[0].push_back({0.0, -1.0});
  const double area = cut_area(polygon, 20.0);
  // Up to y = 20 of 1000 a tooth is hardly narrower than below.
  EXPECT_NEAR(area, 0.5 * 20 * 20 * (1 - 20 / 3.0 / 1000), 2.0);
}

TEST(RegionCutter, CancelsRingsThatLieOnOneAnother) {
  const std::vector<MapPoint> square = {{1, 1}, {5, 1}, {5, 5}, {1, 5}};
  Polygon polygon;
  for (int i = 0; i < 31; ++i) polygon.rings.push_back(square);
  EXPECT_NEAR(cut_area(polygon, 20.0), 16.0, 1e-12);
  polygon.rings.push_back(square);
  EXPECT_NEAR(cut_area(polygon, 20.0), 0.0, 1e-12);
}

TEST(RegionCutter, TakesRingsWhoseSidesLieInOneLine) {
  Polygon polygon;  // each a little longer than the one before, all on one side at x = 3
  double area = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double top = 5 + 0.01 * i;
    polygon.rings.push_back({{3, 1}, {4, 1}, {4, top}, {3, top}});
    area = top - 1 - area;
  }
  EXPECT_NEAR(cut_area(polygon, 20.0), area, 1e-9);
}

TEST(RegionCutter, RefusesThousandsOfSidesInOnePlace) {
  Polygon polygon;
  polygon.rings.emplace_back();
  const auto tip = [](int i) {
    return MapPoint{5 + 4 * std::cos(1e-4 * i), 5 + 4 * std::sin(1e-4 * i)};
  };
  for (int i = 0; i < 10'000; i += 2) {  // the blades of a fan
    polygon.rings[0].push_back({5, 5});
    polygon.rings[0].push_back(tip(i));
    polygon.rings[0].push_back(tip(i + 1));
  }
  EXPECT_THROW(static_cast<void>(cut_area(polygon, 20.0)), Error);
}

}  // namespace
}  // namespace ptin
