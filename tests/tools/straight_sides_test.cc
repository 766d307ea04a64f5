// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sides that are straight in one CRS, in another one: against places that OSR transforms one by
// one, a thousand of each side.
#include "tools/region/straight_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "engine/error.h"

namespace ptin::tools {
namespace {

using Path = std::vector<MapPoint>;

std::unique_ptr<OGRCoordinateTransformation> way_between(int from, int to) {
  OGRSpatialReference a, b;
  a.importFromEPSG(from);
  b.importFromEPSG(to);
  for (OGRSpatialReference* crs : {&a, &b}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return std::unique_ptr<OGRCoordinateTransformation>(OGRCreateCoordinateTransformation(&a, &b));
}

double distance_to_segment(MapPoint p, MapPoint a, MapPoint b) {
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  const double t =
      square == 0 ? 0 : std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0);
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// The farthest that a place of a side is from a path, of `looks` places at equal distances. The
/// path is followed: places and path come in one order.
double worst_bend(MapPoint from, MapPoint to, OGRCoordinateTransformation& way, const Path& path,
                  bool turns, int looks) {
  double worst = 0.0, last = path.front().x;
  std::size_t at = 0;
  for (int i = 0; i <= looks; ++i) {
    const double t = static_cast<double>(i) / looks;
    double x = std::lerp(from.x, to.x, t), y = std::lerp(from.y, to.y, t);
    EXPECT_TRUE(way.Transform(1, &x, &y));
    if (turns) x += 360 * std::round((last - x) / 360);
    last = x;
    const auto to_piece = [&](std::size_t k) {
      return distance_to_segment({x, y}, path[k], path[k + 1]);
    };
    while (at + 2 < path.size() && to_piece(at + 1) < to_piece(at)) ++at;
    worst = std::max(worst, to_piece(at));
  }
  return worst;
}

struct Case {
  int from, to;
  MapPoint a, b;
  double most_bend;
};

TEST(StraightSides, KeepWithinTheBoundOfWhatOsrTransforms) {
  const Case cases[] = {
      {25830, 4326, {450000, 4101000}, {480000, 4101000}, 1.0 / 3600 / 300},  // 30 km
      {25830, 4326, {350000, 4060000}, {560000, 4160000}, 8.3e-6},
      {25830, 25829, {200000, 4060000}, {560000, 4061000}, 0.01},  // into the next zone
      {4326, 32611, {-118.5, 34.0}, {-116.0, 34.0}, 0.3},          // along a parallel
      {4326, 32611, {-118.5, 33.0}, {-118.5, 36.0}, 0.01},
      {3857, 32611, {-13200000, 4000000}, {-12900000, 4300000}, 0.3},
      {32611, 3857, {380000, 3802000}, {780000, 3802000}, 0.05},
      {4326, 3857, {-170, -80}, {170, 80}, 1.0},                  // far across the map
      {4326, 3413, {-120, 70}, {60, 70}, 0.5},                    // half of a parallel, polar
      {3413, 4326, {-2000000, 100000}, {1500000, 100000}, 1e-5},  // by the pole
      {4326, 2154, {-4, 48}, {8, 43}, 0.1},                       // Lambert
      {2154, 32631, {100000, 6200000}, {1200000, 7000000}, 0.25},
      {3035, 25833, {4000000, 3000000}, {5000000, 3000000}, 0.01},  // Lambert of equal areas
      {27700, 4326, {400000, 100000}, {400000, 900000}, 1e-7},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE("EPSG:" + std::to_string(c.from) + " to EPSG:" + std::to_string(c.to));
    const auto way = way_between(c.from, c.to);
    SideTarget target;
    target.most_bend = c.most_bend;
    target.turn = c.to == 4326 ? 360 : 0;
    const Path ends = {c.a, c.b};
    const Path path = transformed_sides(ends, places_by(*way), target);
    const double worst = worst_bend(c.a, c.b, *way, path, target.turn > 0, 10'000);
    EXPECT_LE(worst, c.most_bend);
    EXPECT_GT(worst, 0.001 * c.most_bend) << "no more places than it takes";
    EXPECT_LT(path.size(), 20'000u);
    double x = c.b.x, y = c.b.y;
    ASSERT_TRUE(way->Transform(1, &x, &y));
    EXPECT_NEAR(std::remainder(path.back().x - x, target.turn > 0 ? 360 : 1e9), 0, 1e-9);
    EXPECT_EQ(path.back().y, y) << "corners are transformed as they are";
  }
}

TEST(StraightSides, FindBendsThatTheMiddleDoesNotShow) {
  // A wave of four periods: both ends, the middle and the quarters lie on the chord.
  const PlaceTransform wave = [](std::span<MapPoint> places) {
    for (MapPoint& p : places) p.y += 5 * std::sin(2 * 3.14159265358979323846 * p.x / 250);
  };
  SideTarget target;
  target.most_bend = 0.04;
  const Path path = transformed_sides(Path{{0, 0}, {1000, 0}}, wave, target);
  double worst = 0.0;
  for (int i = 0; i <= 10'000; ++i) {
    MapPoint p{0.1 * i, 0};
    wave({&p, 1});
    double nearest = HUGE_VAL;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      nearest = std::min(nearest, distance_to_segment(p, path[k], path[k + 1]));
    }
    worst = std::max(worst, nearest);
  }
  EXPECT_LE(worst, target.most_bend);
}

TEST(StraightSides, OfCornersAloneAddNothing) {
  const auto way = way_between(4326, 32611);
  SideTarget target;
  target.most_bend = HUGE_VAL;
  const Path line = {{-118.5, 34}, {-116, 34}, {-116, 36}};
  EXPECT_EQ(transformed_sides(line, places_by(*way), target).size(), 3u);
  EXPECT_TRUE(transformed_sides(Path{}, places_by(*way), target).empty());
}

TEST(StraightSides, StayStraightWhereTheTransformationIsLinear) {
  const PlaceTransform turned = [](std::span<MapPoint> places) {
    for (MapPoint& p : places) p = {3 * p.x - 4 * p.y + 7, 4 * p.x + 3 * p.y - 1};
  };
  SideTarget target;
  target.most_bend = 1.0;
  EXPECT_EQ(transformed_sides(Path{{0, 0}, {1000, 0}, {1000, 10}}, turned, target).size(), 3u);
}

TEST(StraightSides, AreTheSameFromEitherEnd) {
  const auto way = way_between(4326, 32611);
  SideTarget target;
  target.most_bend = 0.3;
  Path there = transformed_sides(Path{{-118.5, 34.1}, {-116, 34.7}}, places_by(*way), target);
  const Path back = transformed_sides(Path{{-116, 34.7}, {-118.5, 34.1}}, places_by(*way), target);
  ASSERT_GT(there.size(), 3u);
  std::reverse(there.begin(), there.end());
  EXPECT_EQ(there, back) << "polygons that share a side go on sharing it, bit for bit";
}

TEST(StraightSides, GoOnAcrossTheAntimeridian) {
  const auto way = way_between(32660, 4326);  // UTM 60 N ends at 180
  SideTarget target;
  target.most_bend = 1e-5;
  target.turn = 360;
  target.bounds = Window{179, 50, 181, 52};
  const Path line = {{700000, 5700000}, {780000, 5700000}};
  const Path path = transformed_sides(line, places_by(*way), target);
  EXPECT_LT(path.front().x, 180);
  EXPECT_GT(path.back().x, 180) << "the turn of the terrain";
  EXPECT_LT(worst_bend(line[0], line[1], *way, path, true, 1000), 1e-5);
  target.bounds = Window{-181, 50, -179, 52};
  EXPECT_NEAR(transformed_sides(line, places_by(*way), target).back().x, path.back().x - 360, 1e-9);
  target.bounds = Window{100, 50, 170, 52};
  const Path point = {{-100, 20}};
  const auto same = way_between(4326, 4326);
  EXPECT_EQ(transformed_sides(point, places_by(*same), target).front().x, -100)
      << "what lies within 180 is where it says";
}

void refuses(const Path& path, int from, int to, double most_bend, const std::string& words,
             std::size_t most_points = 1 << 20) {
  const auto way = way_between(from, to);
  SideTarget target;
  target.most_bend = most_bend;
  target.turn = to == 4326 ? 360 : 0;
  target.most_points = most_points;
  try {
    static_cast<void>(transformed_sides(path, places_by(*way), target));
    FAIL() << words;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(StraightSides, AreRefusedWhereTheyBreakOrAreNowhere) {
  refuses({{170, 10}, {190, 20}}, 4326, 3857, 1.0, "breaks in the terrain's CRS, at 18");
  refuses({{0, 80}, {0, 95}}, 4326, 3857, 1.0, "the place 0 95 is nowhere");
  refuses({{-3e6, 0}, {1e6, 0}, {1e6, 2e6}, {-3e6, 2e6}, {-3e6, 0}}, 3413, 4326, 1e-5,
          "breaks in the terrain's CRS");  // a side over the pole itself
  refuses({{-3e6, -1e6}, {1e6, -1e6}, {1e6, 2e6}, {-3e6, 2e6}, {-3e6, -1e6}}, 3413, 4326, 1e-5,
          "around a pole");
  refuses({{-118.5, 34}, {-116, 34}}, 4326, 32611, 1e-3, "more than 10 points", 10);
}

TEST(StraightSides, AimAtAHundredthOfTheDistanceBetweenSamples) {
  StoreFacts facts;
  facts.map = {500000, 4000000, 30, 30};
  facts.bounds = {0, 0, 1000, 1000};
  facts.source_samples = 1001 * 1001;
  EXPECT_NEAR(side_target(facts, 0).most_bend, 0.3, 1e-3) << "of a raster";
  facts.map.step_x = facts.map.step_y = 0.001;  // points, a grid of millimetres
  facts.bounds = {0, 0, 1'000'000, 1'000'000};
  facts.source_samples = 250'000;
  EXPECT_NEAR(side_target(facts, 0).most_bend, 0.02, 1e-9) << "of points two metres apart";
  EXPECT_FALSE(side_target(facts, 0).bounds);
  EXPECT_TRUE(side_target(facts, 360).bounds);
}

}  // namespace
}  // namespace ptin::tools
