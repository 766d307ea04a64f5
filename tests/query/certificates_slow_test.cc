// SPDX-License-Identifier: GPL-3.0-or-later
//
// Certificates over a hundred thousand random points and as many random lines of sight (a sixth,
// where not all are asked for) on real terrains: what is told at an error, or of a file that left detail out, is never wrong.
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/query/heights/locate.h"
#include "engine/query/sight/sight.h"
#include "tests/query/built_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr int kCases = 2000;  // sanitizers are slow
#else
const int kCases = 100'000 / test::share_of_cases(6);
#endif
constexpr double kRounding = 1e-9;  ///< Of heights of some thousand metres.

class Places {
 public:
  Places(const Terrain& terrain, std::uint64_t seed)
      : random_(seed), map_(terrain.store().facts().map), box_(terrain.store().facts().bounds) {}
  MapPoint next() {
    std::uniform_real_distribution<double> x(box_.min_x, box_.max_x), y(box_.min_y, box_.max_y);
    const double at_x = x(random_);
    return map_.to_map(at_x, y(random_));
  }
  /// On the way to another place, mostly near.
  MapPoint near(MapPoint from) {
    const MapPoint to = next();
    const double share = std::pow(std::uniform_real_distribution<double>(0.0, 1.0)(random_), 3.0);
    return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
  }
  double height() { return std::uniform_real_distribution<double>(-2.0, 300.0)(random_); }

 private:
  std::mt19937_64 random_;
  AffineMap map_;
  GridBox box_;
};

struct Question {
  std::string terrain;
  double max_error;  ///< Of the file.
  double tolerance;
};
const std::vector<Question> kQuestions = {{"mountains_257.tif", 0.0, 3.0},
                                          {"mountains_257.tif", 0.0, 40.0},
                                          {"mountains_257.tif", 8.0, 8.0},
                                          {"coast_257.tif", 0.0, 5.0},
                                          {"coast_257.tif", 2.0, 20.0}};

TEST(Certificates, HoldAtManyPoints) {
  for (const Question& q : kQuestions) {
    SCOPED_TRACE(q.terrain + " at " + std::to_string(q.tolerance));
    const Terrain& exact = reference::built_terrain(q.terrain);
    Places places(exact, 11);
    std::vector<MapPoint> points;
    for (int i = 0; i < kCases / static_cast<int>(kQuestions.size()); ++i) {
      points.push_back(places.next());
    }
    LocateRequest request;
    request.detail.tolerance = q.tolerance;
    const LocateResult truth = locate(exact, points);
    const LocateResult told =
        locate(reference::built_terrain(q.terrain, q.max_error), points, request);
    int compared = 0;
    int wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (truth.points[i].state == PointState::kSurface &&
          told.points[i].state == PointState::kSurface) {
        ++compared;
        const double height = truth.points[i].height;
        wrong += told.points[i].height_min > height + kRounding ||
                         told.points[i].height_max < height - kRounding
                     ? 1
                     : 0;
      }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(compared, kCases / 20);
  }
}

TEST(Certificates, HoldOverManyLinesOfSight) {
  int decided = 0;
  for (const Question& q : kQuestions) {
    SCOPED_TRACE(q.terrain + " at " + std::to_string(q.tolerance));
    const Terrain& exact = reference::built_terrain(q.terrain);
    Places places(exact, 12);
    SightRequest request;
    request.absolute = true;  // above ground of a file that left detail out is another question
    SightSolver truth(exact, request);
    request.detail.tolerance = q.tolerance;
    SightSolver coarse(reference::built_terrain(q.terrain, q.max_error), request);
    const double base = exact.store().facts().min_height;
    for (int i = 0; i < kCases / static_cast<int>(kQuestions.size()); ++i) {
      const MapPoint a = places.next();
      const double height_a = base + 3 * places.height();
      const MapPoint b = places.near(a);
      const SightPair pair{a, height_a, b, base + 3 * places.height()};
      const SightResult told = coarse.solve(pair);
      const SightResult known = truth.solve(pair);
      const bool is_certain = told.verdict != SightVerdict::kUndecided;
      ASSERT_TRUE(!is_certain || told.verdict == known.verdict) << i;
      ASSERT_FALSE(told.clearance_min > known.clearance_max + kRounding) << i;
      ASSERT_FALSE(told.clearance_max < known.clearance_min - kRounding) << i;
      decided += is_certain ? 1 : 0;
    }
  }
  EXPECT_GT(decided, kCases / 2);
}

}  // namespace
}  // namespace ptin
