// SPDX-License-Identifier: GPL-3.0-or-later
//
// Point location against the full TIN in memory, and its certificates on real terrains.
#include "engine/query/heights/locate.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/walk/spot_set.h"
#include "engine/query/walk/walk.h"
#include "tests/query/built_terrain.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::nasty_spot;
using reference::Rational;
using reference::rational_of;
using reference::same_number;
using reference::TemporaryStore;

void check_exact(const Hierarchy& h, Spot q, const LocatedPoint& point) {
  const std::vector<TriangleId> at = reference::triangles_at(h.full, rational_of(q));
  if (at.empty()) {
    RC_ASSERT(point.state == PointState::kOutside);
    return;
  }
  const TriangleId t = reference::answering_among(h.full, at);
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId v = h.full.triangles[t].v[i];
    RC_ASSERT(std::any_of(point.triangle.begin(), point.triangle.end(), [&](const auto& c) {
      return c.position == h.full.position(v) &&
             (h.full.has_height[v] == 0
                  ? std::isnan(c.height)
                  : c.height == h.facts.heights.height(h.full.vertices[v].height));
    }));
  }
  const bool surface = h.full.classes[t] == TriangleClass::kSurface;
  RC_ASSERT(point.state == (surface ? PointState::kSurface : PointState::kVoid));
  RC_ASSERT(std::isnan(point.height) == !surface);
  if (surface) {
    const Rational exact = Rational(h.facts.heights.offset) +
                           Rational(h.facts.heights.step) *
                               reference::code_on(h.full, h.facts.heights, t, rational_of(q));
    RC_ASSERT(abs(Rational(point.height) - exact) <= Rational(1e-12));
    RC_ASSERT(point.height_min == point.height);
    RC_ASSERT(point.height_max == point.height);
  }
}

RC_GTEST_PROP(Locate, GivesTheFullTinsAnswerAtAnyPoint, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  std::vector<Spot> spots(16);
  std::vector<MapPoint> points;
  for (Spot& s : spots) {
    s = nasty_spot(random, h.full);
    points.push_back(map.map(s));
    RC_ASSERT(map.spot(points.back()) == s);  // this map loses nothing
  }
  const LocateResult all = locate(terrain, points);
  RC_ASSERT(all.exact);
  RC_ASSERT(all.certified_error == 0);
  for (std::size_t i = 0; i < spots.size(); ++i) {
    check_exact(h, spots[i], all.points[i]);
    const LocateResult one = locate(terrain, {&points[i], 1});
    check_exact(h, spots[i], one.points[0]);
  }
}

RC_GTEST_PROP(SpotSet, HoldsWhereABoxHoldsASpot, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const int reach = 1 + static_cast<int>(random() % 60);
  const auto coordinate = [&] {
    const auto grid = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(reach));
    return (grid << kSpotBits) +
           (random() % 2 == 0 ? 0 : static_cast<std::int64_t>(random() % (1 << kSpotBits)));
  };
  std::vector<Spot> spots(1 + random() % 200);
  for (Spot& s : spots) s = {coordinate(), coordinate()};
  const SpotSet set(spots, 2.0);
  for (int i = 0; i < 200; ++i) {
    const auto at = [&] {
      return static_cast<int>(random() % static_cast<std::uint64_t>(reach + 4)) - 2;
    };
    GridBox box = box_of(GridPoint{at(), at()});
    box = united(
        box, random() % 2 == 0 ? GridPoint{at(), at()} : GridPoint{box.min_x + 1, box.min_y + 2});
    const bool wanted =
        std::any_of(spots.begin(), spots.end(), [&](Spot s) { return contains(box, s); });
    RC_ASSERT(set.holds({box, {}, 3.0, 0.0}) == wanted);
    RC_ASSERT(!set.holds({box, {}, 2.0, 0.0}));
  }
}

std::vector<MapPoint> random_points(const StoreFacts& f, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> x(f.bounds.min_x - 3, f.bounds.max_x + 3);
  std::uniform_real_distribution<double> y(f.bounds.min_y - 3, f.bounds.max_y + 3);
  std::vector<MapPoint> points(count);
  for (MapPoint& p : points) {
    const bool at_sample = random() % 4 == 0;
    const double gx = x(random);
    const double gy = y(random);
    p = at_sample ? f.map.to_map(std::round(gx), std::round(gy)) : f.map.to_map(gx, gy);
  }
  return points;
}

TEST(Locate, BatchesAnswerAsSinglePointsDoInTheOrderOfTheRequest) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const std::vector<MapPoint> points = random_points(terrain.store().facts(), 20000, 3);
  const LocateResult all = locate(terrain, points);
  ASSERT_EQ(all.points.size(), points.size());
  for (std::size_t i = 0; i < points.size(); i += 97) {
    const LocateResult one = locate(terrain, {&points[i], 1});
    EXPECT_EQ(one.points[0].state, all.points[i].state);
    EXPECT_TRUE(same_number(one.points[0].height, all.points[i].height));
  }
}

void expect_same(const LocatedPoint& a, const LocatedPoint& b) {
  EXPECT_EQ(a.state, b.state);
  EXPECT_TRUE(same_number(a.height, b.height) && same_number(a.height_min, b.height_min) &&
              same_number(a.height_max, b.height_max))
      << a.height << " in " << a.height_min << " to " << a.height_max << ", " << b.height << " in "
      << b.height_min << " to " << b.height_max;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(a.triangle[i].position, b.triangle[i].position);
    EXPECT_TRUE(same_number(a.triangle[i].height, b.triangle[i].height));
  }
}

/// The paper's way is the oracle: state, height, interval and triangle are the same, bit for bit.
TEST(Locate, AnswersByHeightsAndStarsAsBySplits) {
  for (const auto& [name, max_error] : {std::pair{"mountains_257.tif", 0.0},
                                        {"mountains_257.tif", 3.0},
                                        {"coast_257.tif", 0.0},
                                        {"coast_257.tif", 1.0}}) {
    const Terrain& terrain = reference::built_terrain(name, max_error);
    const std::vector<MapPoint> points = random_points(terrain.store().facts(), 4000, 5);
    std::vector<DetailRequest> levels;
    for (const double error : {0.0, 0.7, 5.0, 21.3, 1e5}) levels.push_back({error, {}});
    for (const std::uint64_t vertices : {4, 50, 3000, 20001}) levels.push_back({{}, vertices});
    levels.emplace_back();  // all detail
    for (const DetailRequest& level : test::some_of(levels)) {
      SCOPED_TRACE(testing::Message() << name << " at " << level.tolerance.value_or(-1.0) << ", "
                                      << level.vertices.value_or(0));
      LocateRequest request;
      request.detail = level;
      const LocateResult best = terrain.locate(points, request);
      const LocateResult stars = terrain.locate(points, request, AnswerBy::kStars);
      const LocateResult few =
          terrain.locate(std::span(points).first(40), request, AnswerBy::kStars);
      const LocateResult splits = terrain.locate(points, request, AnswerBy::kSplits);
      const bool has_heights = max_error == 0 && !level.tolerance && !level.vertices;
      EXPECT_EQ(best.cost.stars_read == 0, has_heights || stars.cost.stars_read == 0);
      EXPECT_LE(best.cost.io.pages, stars.cost.io.pages);
      EXPECT_EQ(stars.certified_error, splits.certified_error);
      EXPECT_EQ(stars.certified_deviation, splits.certified_deviation);
      EXPECT_EQ(stars.cost.records_applied, 0U);
      const bool is_t0 = level.tolerance > 1000 || level.vertices == 4U;
      EXPECT_TRUE(stars.cost.stars_read > 0 || is_t0);
      EXPECT_EQ(splits.cost.stars_read, 0U);
      for (std::size_t i = 0; i < points.size(); ++i) {
        expect_same(best.points[i], splits.points[i]);
        expect_same(stars.points[i], splits.points[i]);
        if (i < few.points.size()) expect_same(few.points[i], splits.points[i]);
        if (HasFailure()) return;
      }
    }
  }
}

RC_GTEST_PROP(Locate, AnswersByStarsAsBySplitsOnAnyTerrain, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open(random() % 2 == 0 ? PageAccess::kMapped : PageAccess::kPread));
  const SpotMap map(h.facts.map, h.facts.bounds);
  std::vector<MapPoint> points(24);
  for (MapPoint& p : points) p = map.map(nasty_spot(random, h.full));
  LocateRequest request;
  const auto kind = random() % 4;
  if (!h.records.empty() && kind == 1) {
    request.detail.tolerance = h.records[random() % h.records.size()].error;
  } else if (kind > 1) {
    request.detail.vertices = terrain.t0().vertices.size() + random() % (h.records.size() + 1);
  }
  const LocateResult stars = locate(terrain, points, request);
  const LocateResult splits = terrain.locate(points, request, AnswerBy::kSplits);
  for (std::size_t i = 0; i < points.size(); ++i) {
    expect_same(stars.points[i], splits.points[i]);
  }
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(Locate, GroupsAreHalvedUntilTheyFitTheMemory) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const std::vector<MapPoint> points = random_points(terrain.store().facts(), 3000, 4);
  LocateRequest request;
  const LocateResult free = terrain.locate(points, request, AnswerBy::kSplits);
  request.limits.memory_bytes = 3000 * 200 + (std::uint64_t{3} << 20);
  const LocateResult tight = terrain.locate(points, request, AnswerBy::kSplits);
  EXPECT_GT(tight.cost.records_applied, free.cost.records_applied);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(same_number(free.points[i].height, tight.points[i].height));
  }
  request.limits.memory_bytes = 1000;
  EXPECT_THROW(static_cast<void>(terrain.locate(points, request, AnswerBy::kSplits)), Error);
}

/// The exact height lies in every interval that an approximation reports.
void check_intervals(const Terrain& exact, const Terrain& asked, const LocateRequest& request,
                     std::uint64_t seed) {
  const std::vector<MapPoint> points = random_points(exact.store().facts(), 20000, seed);
  const LocateResult truth = locate(exact, points);
  const LocateResult found = locate(asked, points, request);
  std::size_t both = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LocatedPoint& f = found.points[i];
    EXPECT_EQ(f.state == PointState::kOutside, truth.points[i].state == PointState::kOutside);
    if (f.state == PointState::kSurface) {
      ASSERT_LE(f.height_min, f.height);
      ASSERT_GE(f.height_max, f.height);
    }
    if (f.state == PointState::kSurface && truth.points[i].state == PointState::kSurface) {
      ++both;
      ASSERT_LE(f.height_min, truth.points[i].height) << i;
      ASSERT_GE(f.height_max, truth.points[i].height) << i;
    }
  }
  EXPECT_GT(both, points.size() / 4);
  EXPECT_EQ(found.exact,
            found.certified_error == 0 && !request.detail.tolerance && !request.detail.vertices);
}

LocateRequest at(double tolerance) {
  LocateRequest request;
  request.detail.tolerance = tolerance;
  return request;
}

TEST(Locate, IntervalsHoldTheExactHeight) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    const Terrain& terrain = reference::built_terrain(name);
    for (const double tolerance : {0.0, 1.0, 8.0, 60.0, 1000.0}) {
      check_intervals(terrain, terrain, at(tolerance), 5);
    }
    for (const std::uint64_t records : {2000U, 20000U}) {
      LocateRequest request;
      request.detail.vertices = terrain.store().t0().vertices.size() + records;
      check_intervals(terrain, terrain, request, 8);
    }
  }
}

TEST(Locate, FilesThatLeftRecordsOutAnswerWithIntervals) {
  const Terrain& exact = reference::built_terrain("mountains_257.tif");
  const Terrain& coarse = reference::built_terrain("mountains_257.tif", 10.0);
  check_intervals(exact, coarse, {}, 6);
  check_intervals(exact, coarse, at(20.0), 7);
  const LocateResult r = locate(coarse, random_points(coarse.store().facts(), 10, 1));
  EXPECT_FALSE(r.exact);
  EXPECT_GT(r.certified_error, 0.0);
  EXPECT_LE(r.certified_error, 10.0);
}

TEST(Locate, RejectsWhatIsNoPositionOrTolerance) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const std::vector<MapPoint> bad = {{0, 0}, {std::nan(""), 0}};
  try {
    static_cast<void>(locate(terrain, bad));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find("point 1"), std::string::npos);
  }
  LocateRequest request;
  request.detail.tolerance = -1.0;
  EXPECT_THROW(static_cast<void>(locate(terrain, {bad.data(), 1}, request)), Error);
  const std::vector<MapPoint> far = {{1e300, -1e300}};
  EXPECT_EQ(locate(terrain, far).points[0].state, PointState::kOutside);
  EXPECT_TRUE(locate(terrain, {}).points.empty());
}

}  // namespace
}  // namespace ptin
