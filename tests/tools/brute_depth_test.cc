// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/brute_depth.h"

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

TEST(DepthAt, IsTheLeastDistanceToTheOtherClass) {
  std::mt19937 random(5);
  for (int i = 0; i < 50; ++i) {
    std::vector<std::string> rows(9, std::string(11, '#'));
    for (auto& row : rows) {
      for (char& c : row) c = random() % 12 == 0 ? '.' : '#';
    }
    const SampleWindow window = window_of(rows);
    const GroundSteps steps{2.0, 3.0};
    for (const SourceSample& s : window.samples) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const SourceSample& o : window.samples) {
        if (o.is_void != s.is_void)
          nearest = std::min(nearest, std::hypot(2.0 * (o.x - s.x), 3.0 * (o.y - s.y)));
      }
      EXPECT_NEAR(depth_at(window, s.x, s.y, steps, 1e9), nearest, 1e-12);
      const double limited = depth_at(window, s.x, s.y, steps, 4.5);
      if (nearest <= 4.5) {
        EXPECT_NEAR(limited, nearest, 1e-12);
      } else {
        EXPECT_TRUE(std::isinf(limited));
      }
    }
  }
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
