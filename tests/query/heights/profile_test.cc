// SPDX-License-Identifier: GPL-3.0-or-later
//
// Profiles against every triangle of the full TIN, and against point location.
#include "engine/query/heights/profile.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/heights/locate.h"
#include "engine/query/questions.h"
#include "engine/query/walk/spot_path.h"
#include "tests/query/built_terrain.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::nasty_spot;
using reference::rational_of;

RC_GTEST_PROP(Profile, BreaksWhereTheFullTinDoesAtItsHeights, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  for (int i = 0; i < 3; ++i) {
    const Spot p = nasty_spot(random, h.full);
    const Spot q = nasty_spot(random, h.full);
    if (p == q) {
      continue;
    }
    const MapPoint line[] = {map.map(p), map.map(q)};
    const ProfileResult found = profile(terrain, line);
    RC_ASSERT(found.exact);
    auto wanted = reference::stops(h.full, rational_of(p), rational_of(q));
    wanted.insert(0);  // the ends of the line, wherever they are
    wanted.insert(1);
    RC_ASSERT(found.points.size() == wanted.size());
    const double length = found.points.back().distance;
    std::size_t k = 0;
    for (const reference::Rational& share : wanted) {
      const ProfilePoint& point = found.points[k++];
      RC_ASSERT(std::abs(point.distance - length * share.convert_to<double>()) < 1e-9 * length);
      const auto at = reference::along(rational_of(p), rational_of(q), share);
      for (const TriangleId t : reference::triangles_at(h.full, at)) {
        if (!std::isnan(point.height) && h.full.classes[t] == TriangleClass::kSurface) {
          const double exact = h.facts.heights.height_of_code(
              reference::code_on(h.full, h.facts.heights, t, at).convert_to<double>());
          RC_ASSERT(std::abs(point.height - exact) < 1e-9);
        }
      }
    }
  }
}

TEST(Profile, StopsWhereALineTouchesACornerOfTheDomain) {
  const Hierarchy h = reference::random_hierarchy(11);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const GridBox& b = h.facts.bounds;
  const auto map_of = [&](std::int32_t x, std::int32_t y) { return h.facts.map.to_map(x, y); };
  const MapPoint corner = map_of(b.min_x, b.min_y);
  const LocatedPoint ground = locate(terrain, std::span(&corner, 1)).points[0];
  for (const std::int32_t before : {0, 3, 6}) {  // the corner stands before, within, behind
    const MapPoint line[] = {map_of(b.min_x - before, b.min_y + before),
                             map_of(b.min_x - before + 6, b.min_y + before - 6)};
    const ProfileResult found = profile(terrain, line);
    ASSERT_EQ(found.points.size(), before == 3 ? 3U : 2U);
    const ProfilePoint& at = found.points[before == 0 ? 0 : 1];
    EXPECT_EQ(at.state, PointState::kOutside);
    EXPECT_DOUBLE_EQ(at.position.x, corner.x);
    EXPECT_DOUBLE_EQ(at.position.y, corner.y);
    EXPECT_EQ(at.height, ground.height);
    EXPECT_EQ(std::count_if(found.points.begin(), found.points.end(),
                            [](const ProfilePoint& p) { return std::isnan(p.height); }),
              static_cast<std::ptrdiff_t>(found.points.size()) - 1);
  }
}

TEST(Profile, FollowsALineOfSeveralSegments) {
  const Hierarchy h = reference::random_hierarchy(11);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const GridBox& b = h.facts.bounds;
  const MapPoint line[] = {
      h.facts.map.to_map(b.min_x, b.min_y), h.facts.map.to_map(b.max_x, b.min_y),
      h.facts.map.to_map(b.max_x, b.min_y), h.facts.map.to_map(b.max_x, b.max_y)};
  const ProfileResult found = profile(terrain, line);
  EXPECT_DOUBLE_EQ(found.points.back().distance,
                   0.5 * (b.max_x - b.min_x) + 0.5 * (b.max_y - b.min_y));
  for (std::size_t i = 1; i < found.points.size(); ++i) {
    EXPECT_LT(found.points[i - 1].distance, found.points[i].distance);
  }
  EXPECT_EQ(found.points.back().part, 1u);
}

/// The box meets a segment, in rationals: it holds an end, or the segment crosses one of its sides.
bool meets_segment(const GridBox& box, Spot p, Spot q) {
  reference::Rational from = 0;
  reference::Rational to = 1;
  const auto a = rational_of(p);
  const auto b = rational_of(q);
  const auto clip = [&](const reference::Rational& start, const reference::Rational& step,
                        std::int32_t low, std::int32_t high) {
    if (step == 0) return low <= start && start <= high;
    reference::Rational first = (low - start) / step;
    reference::Rational last = (high - start) / step;
    if (last < first) std::swap(first, last);
    from = std::max(from, first);
    to = std::min(to, last);
    return from <= to;
  };
  return clip(a.x, b.x - a.x, box.min_x, box.max_x) && clip(a.y, b.y - a.y, box.min_y, box.max_y);
}

RC_GTEST_PROP(SpotPath, HoldsWhereABoxMeetsASegment, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto coordinate = [&] {
    const auto grid = static_cast<std::int64_t>(random() % 40);
    return (grid << kSpotBits) +
           (random() % 2 == 0 ? 0 : static_cast<std::int64_t>(random() % (1 << kSpotBits)));
  };
  std::vector<Spot> spots(2 + random() % 30);
  for (Spot& s : spots) {
    s = {coordinate(), coordinate()};
    if (random() % 4 == 0) s = {s.x, spots.front().y};
  }
  std::vector<SpotSegment> segments;
  for (std::size_t k = 0; k + 1 < spots.size(); ++k) segments.push_back({spots[k], spots[k + 1]});
  const SpotPath path(segments);
  for (int i = 0; i < 100; ++i) {
    const auto at = [&] { return static_cast<int>(random() % 44) - 2; };
    GridBox box = box_of(GridPoint{at(), at()});
    box = united(box, random() % 4 == 0 ? GridPoint{at(), at()}
                                        : GridPoint{box.min_x + static_cast<int>(random() % 3),
                                                    box.min_y + static_cast<int>(random() % 3)});
    std::vector<std::size_t> wanted, found;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      if (meets_segment(box, segments[k].a, segments[k].b)) wanted.push_back(k);
    }
    path.visit(box, [&](std::size_t k) { found.push_back(k); });
    RC_ASSERT(found == wanted);
    RC_ASSERT(path.meets(box) == !wanted.empty());
    RC_ASSERT(path.may_hold({box, {}, 0.0, 0.0}) == !wanted.empty());
    RC_ASSERT(wanted.empty() || meets(path.bounds(), box));
  }
}

/// Pieces are read one after the other, so that what lies near their ends is looked at twice.
void answers_pieces(const Terrain& terrain) {
  const StoreFacts& f = terrain.store().facts();
  std::mt19937_64 random(5);
  std::vector<MapPoint> track;
  for (int i = 0; i < 400; ++i) {
    track.push_back(f.map.to_map(f.bounds.min_x + static_cast<double>(random() % 1000) * 1e-3 *
                                                      (f.bounds.max_x - f.bounds.min_x),
                                 f.bounds.min_y + i * (f.bounds.max_y - f.bounds.min_y) / 400.0));
  }
  const ProfileResult free = profile(terrain, track);
  ProfileRequest request;
  request.limits.memory_bytes = free.points.size() * sizeof(ProfilePoint) * 3 / 2;
  const ProfileResult tight = profile(terrain, track, request);
  EXPECT_GT(tight.cost.stars_read + tight.cost.samples_read,
            free.cost.stars_read + free.cost.samples_read)
      << "it was not cut";
  ASSERT_EQ(tight.points.size(), free.points.size());
  for (std::size_t i = 0; i < free.points.size(); ++i) {
    ASSERT_EQ(tight.points[i].distance, free.points[i].distance);
    ASSERT_EQ(tight.points[i].height, free.points[i].height);
  }
  request.limits.memory_bytes = 1000;
  EXPECT_THROW(static_cast<void>(profile(terrain, track, request)), Error);
}

Terrain by_stars(const Terrain& terrain) {
  Terrain stars = terrain;
  stars.use_floor(false);
  return stars;
}

TEST(Profile, AnswersThePiecesOfALineThatDoesNotFitTheMemory) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  answers_pieces(terrain);
  answers_pieces(by_stars(terrain));
}

TEST(Profile, KeepsLinesApart) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& f = terrain.store().facts();
  const auto at = [&](int x, int y) {
    return f.map.to_map(f.bounds.min_x + x, f.bounds.min_y + y);
  };
  const std::vector<std::vector<MapPoint>> lines = {{at(3, 3), at(40, 9)}, {at(80, 3), at(90, 70)}};
  const ProfileResult both = profile(terrain, lines);
  std::size_t i = 0;
  for (std::uint32_t line = 0; line < 2; ++line) {
    for (const ProfilePoint& p : profile(terrain, lines[line]).points) {
      ASSERT_LT(i, both.points.size());
      EXPECT_EQ(both.points[i].line, line);
      EXPECT_EQ(both.points[i].distance, p.distance);
      EXPECT_EQ(both.points[i].height, p.height);
      ++i;
    }
  }
  EXPECT_EQ(i, both.points.size());
}

void shares_pages(const Terrain& terrain) {
  const StoreFacts& f = terrain.store().facts();
  std::mt19937_64 random(8);
  const auto at = [&](double x, double y) {
    return f.map.to_map(f.bounds.min_x + x, f.bounds.min_y + y);
  };
  std::vector<std::vector<MapPoint>> lines;
  for (int i = 0; i < 300; ++i) {
    const double x = double(random() % 2700) / 10 - 5;
    const double y = double(random() % 2700) / 10 - 5;
    lines.push_back({at(x, y), at(x + double(random() % 200) / 10, y + 7.5), at(x, y + 9)});
    if (i % 50 == 0) lines.push_back({at(x, y), at(x, y)});  // without length
  }
  ProfileRequest request;
  for (const std::uint64_t memory : {std::uint64_t{1} << 32, std::uint64_t{5} << 20}) {
    request.limits.memory_bytes = memory;
    const ProfileResult all = profile(terrain, lines, request);
    EXPECT_EQ(all.skipped_lines, 6U);
    std::size_t i = 0;
    std::uint64_t alone = 0, records = 0;
    for (std::uint32_t line = 0; line < lines.size(); ++line) {
      if (lines[line][0] == lines[line][1]) continue;
      const ProfileResult one = profile(terrain, lines[line]);
      alone += one.cost.io.pages;
      records += one.cost.records_examined;
      for (const ProfilePoint& p : one.points) {
        ASSERT_LT(i, all.points.size());
        ASSERT_EQ(all.points[i].line, line);
        ASSERT_EQ(all.points[i].distance, p.distance);
        ASSERT_EQ(all.points[i].position, p.position);
        ASSERT_EQ(all.points[i].state, p.state);
        if (!std::isnan(p.height)) {
          ASSERT_EQ(all.points[i].height, p.height);
        }
        ++i;
      }
    }
    EXPECT_EQ(i, all.points.size());
    EXPECT_LT(all.cost.io.pages, alone / 2);
    EXPECT_LE(all.cost.records_examined, records / 2);  // by heights there are none
  }
}

TEST(Profile, SharesPagesAndKeepsTheOrderOfManyLines) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  shares_pages(terrain);
  shares_pages(by_stars(terrain));
}

/// The breaks of a line are all there and as they were, every point else is a station, and a station
/// stands at each multiple of the step and at the end.
void check_stations(std::span<const ProfilePoint> found, std::span<const ProfilePoint> breaks,
                    double step) {
  double steps = 0;
  double reached = -1;
  for (const ProfilePoint& p : found) {
    RC_ASSERT(p.distance > reached);
    reached = p.distance;
    const bool is_break = !breaks.empty() && breaks.front().distance == p.distance;
    if (is_break) {
      RC_ASSERT(breaks.front().position == p.position && breaks.front().state == p.state);
      RC_ASSERT(breaks.front().part == p.part);
      breaks = breaks.subspan(1);
    }
    RC_ASSERT(p.is_station || (is_break && !breaks.empty()));
    const bool is_end_alone = breaks.empty() && p.distance < steps * step - 1e-6;
    if (p.is_station && !is_end_alone) {
      RC_ASSERT(std::abs(p.distance - steps * step) < 1e-6);
      ++steps;
    }
  }
  RC_ASSERT(breaks.empty() && steps * step > reached);
}

/// Every point stands at the height of its place, by point location: there, or a little beside it,
/// since a line along a border falls to either side of it by rounding. What is near a break is left
/// out.
void check_heights(const Terrain& terrain, std::span<const ProfilePoint> found,
                   std::span<const ProfilePoint> breaks) {
  constexpr double kBeside = 1e-6;  // some spots
  for (const ProfilePoint& p : found) {
    if (std::any_of(breaks.begin(), breaks.end(), [&](const ProfilePoint& b) {
          return std::abs(b.distance - p.distance) < 1e-4;
        })) {
      continue;
    }
    const auto& [x, y] = p.position;
    const MapPoint places[] = {
        p.position, {x - kBeside, y}, {x + kBeside, y}, {x, y - kBeside}, {x, y + kBeside}};
    const LocateResult located = terrain.locate(places, {});
    RC_ASSERT(std::isnan(p.height) == (p.state != PointState::kSurface));
    RC_ASSERT(std::any_of(located.points.begin(), located.points.end(), [&](const auto& at) {
      return at.state == p.state && (std::isnan(p.height) || std::abs(p.height - at.height) < 1e-6);
    }));
  }
}

std::span<const ProfilePoint> points_of(const ProfileResult& profile, std::uint32_t line) {
  const auto [begin, end] =
      std::ranges::equal_range(profile.points, line, {}, [](const auto& p) { return p.line; });
  return {begin, end};
}

RC_GTEST_PROP(Profile, StandsAtEveryStationAtTheHeightOfItsPlace, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  std::vector<std::vector<MapPoint>> lines(2);
  for (auto& line : lines) {
    while (line.size() < 3) line.push_back(map.map(nasty_spot(random, h.full)));
    if (line[0] == line[1] && line[1] == line[2]) return;
  }
  const ProfileResult breaks = terrain.profile(lines, {});
  ProfileRequest request;
  request.station_step = random() % 2 == 0 ? 0.25 : 0.01 + 1e-6 * double(random() % 2'000'000);
  const ProfileResult found = terrain.profile(lines, request);
  for (std::uint32_t line = 0; line < 2; ++line) {
    check_stations(points_of(found, line), points_of(breaks, line), request.station_step);
    check_heights(terrain, points_of(found, line), points_of(breaks, line));
  }
}

TEST(Profile, TakesABreakAtAStationForOnePoint) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& f = terrain.store().facts();
  const MapPoint line[] = {f.map.to_map(10, 20), f.map.to_map(30, 20)};  // along a row of samples
  ProfileRequest request;
  request.station_step = f.map.step_x;
  const ProfileResult found = terrain.profile(line, request);
  ASSERT_EQ(found.points.size(), 21U);
  for (const ProfilePoint& p : found.points) EXPECT_TRUE(p.is_station);
  request.station_step = 7 * f.map.step_x;
  std::size_t stations = 0;
  for (const ProfilePoint& p : terrain.profile(line, request).points) stations += p.is_station;
  EXPECT_EQ(stations, 4U);  // at 0, 7 and 14 steps, and the end
}

TEST(Profile, RefusesMoreStationsThanTheMemoryHolds) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& f = terrain.store().facts();
  const MapPoint line[] = {f.map.to_map(10, 20), f.map.to_map(30, 20)};
  ProfileRequest request;
  for (const double step : {1e-6, 1e-300, 5e-324}) {
    request.station_step = step;
    try {
      static_cast<void>(terrain.profile(line, request));
      FAIL() << step;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
      EXPECT_NE(e.message().find("stations take"), std::string::npos) << e.what();
    }
  }
  for (const double step : {-1.0, std::nan(""), HUGE_VAL}) {
    request.station_step = step;
    EXPECT_THROW(static_cast<void>(terrain.profile(line, request)), Error) << step;
  }
}

TEST(Profile, RejectsWhatIsNoLine) {
  const Hierarchy h = reference::random_hierarchy(12);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const MapPoint one[] = {{1000, -500}, {1000, -500}};
  const MapPoint bad[] = {{1000, -500}, {std::nan(""), 0}};
  EXPECT_THROW(static_cast<void>(profile(terrain, one)), Error);
  EXPECT_THROW(static_cast<void>(profile(terrain, bad)), Error);
}

}  // namespace
}  // namespace ptin
