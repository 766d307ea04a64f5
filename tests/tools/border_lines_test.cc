// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/border_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

namespace ptin::tools {
namespace {

SampleWindow window_of(const std::vector<std::string>& rows) {  // row 0 in the south; '.' is void
  SampleWindow window;
  window.is_grid = true;
  window.box = {0, 0, static_cast<std::int32_t>(rows[0].size()) - 1,
                static_cast<std::int32_t>(rows.size()) - 1};
  for (std::int32_t y = 0; y <= window.box.max_y; ++y) {
    for (std::int32_t x = 0; x <= window.box.max_x; ++x) {
      window.samples.push_back(
          {x, y, 0.0, rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '.'});
    }
  }
  return window;
}

TEST(BorderLines, MeasureTheDistanceToTheNearestOfThem) {
  std::mt19937 random(5);
  for (int i = 0; i < 50; ++i) {
    std::vector<BorderLine> lines;
    for (int k = 0; k < 1 + i * 3; ++k) {
      const auto at = [&] { return static_cast<std::int32_t>(random() % 200); };
      const GridPoint a{at(), at()};
      lines.push_back({a, GridPoint{a.x + 1 + at() % 30, a.y + at() % 30}});
    }
    const GroundSteps steps{2.0, 3.0};
    const BorderLines border(lines, steps);
    for (int k = 0; k < 40; ++k) {
      const double x = static_cast<double>(random() % 3000) / 10 - 40;
      const double y = static_cast<double>(random() % 3000) / 10 - 40;
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [a, b] : lines) {  // the distance along a line has one minimum
        double low = 0.0, high = 1.0;
        const auto at = [&, p = a, q = b](double t) {
          return std::hypot(2.0 * (p.x + (q.x - p.x) * t - x), 3.0 * (p.y + (q.y - p.y) * t - y));
        };
        for (int f = 0; f < 90; ++f) {
          const double third = (high - low) / 3;
          (at(low + third) < at(high - third) ? high : low) =
              at(low + third) < at(high - third) ? high - third : low + third;
        }
        nearest = std::min(nearest, at(low));
      }
      EXPECT_NEAR(border.distance(x, y, 1e9), nearest, 1e-5);
      if (nearest > 1e-5) {
        EXPECT_TRUE(std::isinf(border.distance(x, y, nearest / 2)));
      }
    }
  }
}

TEST(BorderLines, OfAMaskLieBetweenSurfaceAndVoid) {
  // A cell with three heights is half surface; one with fewer is void.
  const SampleWindow window = window_of({"####", "####", "##..", "#..#"});
  std::vector<BorderLine> lines = border_of_mask(window);
  std::sort(lines.begin(), lines.end(), [](const BorderLine& a, const BorderLine& b) {
    return std::pair(key_of(a[0]), key_of(a[1])) < std::pair(key_of(b[0]), key_of(b[1]));
  });
  const std::vector<BorderLine> expected = {{GridPoint{2, 1}, GridPoint{3, 1}},
                                            {GridPoint{2, 1}, GridPoint{1, 2}},
                                            {GridPoint{1, 2}, GridPoint{0, 3}}};
  EXPECT_EQ(lines, expected);
}

TEST(DropLoneSamples, TakesThoseWithoutASurfaceTriangle) {
  SampleWindow window = window_of({"#....", ".....", "..##.", "..#..", "#...#"});
  drop_lone_samples(window);
  int kept = 0;
  for (const SourceSample& s : window.samples) kept += !s.is_void;
  EXPECT_EQ(kept, 3);
  EXPECT_TRUE(window.samples[0].is_lone);
}

TEST(GroundSteps, AreMetresInDegrees) {
  const AffineMap map{0.0, 60.0, 0.01, 0.01};
  const auto ground_in = [](const std::string& crs) {
    OGRSpatialReference srs;
    EXPECT_EQ(srs.SetFromUserInput(crs.c_str()), OGRERR_NONE);
    char* wkt = nullptr;
    EXPECT_EQ(srs.exportToWkt(&wkt), OGRERR_NONE);
    const std::string text(wkt);
    CPLFree(wkt);
    return ground_of(crs_facts(text));
  };
  const GroundSteps steps = ground_steps(map, ground_in("EPSG:4326"), 0);
  EXPECT_NEAR(steps.x, 558.0, 0.1);
  EXPECT_NEAR(steps.y, 1114.1, 0.1);
  EXPECT_EQ(ground_steps(map, ground_in("EPSG:32633"), 0).x, 0.01);
  // The Moon is a ball: half a degree of longitude at 60 degrees is as long as a degree of latitude
  // halved again.
  const GroundSteps moon = ground_steps(map, ground_in("+proj=longlat +R=1737400"), 0);
  EXPECT_NEAR(moon.y, 0.01 * M_PI / 180 * 1737400, 1e-6);
  EXPECT_NEAR(moon.x, moon.y / 2, 1e-6);
}

}  // namespace
}  // namespace ptin::tools
