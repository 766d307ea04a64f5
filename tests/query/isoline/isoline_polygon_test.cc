// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of polygons against those of the whole terrain, cut in rationals.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/isoline/isoline_listing.h"
#include "tests/query/polygon_oracle.h"

namespace ptin {
namespace {

using reference::any_polygon;
using reference::distance_to_border;
using reference::Hierarchy;
using reference::listing;
using reference::Rational;
using reference::rational_of;
using reference::stretches_in;
using reference::TemporaryStore;

/// Coordinates are about 1000, and cuts a few roundings off.
constexpr double kRounding = 1e-9;

struct Stretch {
  double level;
  MapPoint from, to;
};

double length_of(const Stretch& s) { return std::hypot(s.to.x - s.from.x, s.to.y - s.from.y); }

double length_of(const std::vector<Stretch>& stretches) {
  double length = 0.0;
  for (const Stretch& s : stretches) length += length_of(s);
  return length;
}

std::vector<Stretch> stretches_of(const Isolines& lines) {
  std::vector<Stretch> all;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    for (std::size_t k = 0; k + 1 < line.points.size(); ++k) {
      all.push_back({lines.levels()[line.level], line.points[k], line.points[k + 1]});
    }
  }
  return all;
}

/// The parts of each stretch that lie in the polygon.
std::vector<Stretch> cut_in_rationals(const std::vector<Stretch>& whole, const Polygon& polygon) {
  std::vector<Stretch> cut;
  for (const Stretch& s : whole) {
    for (const reference::Shares& shares : stretches_in(polygon, s.from, s.to)) {
      const auto at = [&](const Rational& share) {
        const reference::RationalPoint p =
            reference::along(rational_of(s.from), rational_of(s.to), share);
        return MapPoint{p.x.convert_to<double>(), p.y.convert_to<double>()};
      };
      const Stretch part{s.level, at(shares.from), at(shares.to)};
      if (length_of(part) > kRounding) cut.push_back(part);
    }
  }
  return cut;
}

/// Whether the stretches are the same, but for rounding, and for stretches as short as that.
void expect_same(const std::vector<Stretch>& got, const std::vector<Stretch>& want) {
  EXPECT_NEAR(length_of(got), length_of(want), 1e-7);
  const auto is_near = [](MapPoint a, MapPoint b) {
    return std::hypot(a.x - b.x, a.y - b.y) <= kRounding;
  };
  for (const Stretch& g : got) {
    if (length_of(g) <= 2 * kRounding) continue;
    EXPECT_TRUE(std::any_of(want.begin(), want.end(),
                            [&](const Stretch& w) {
                              return w.level == g.level && is_near(w.from, g.from) &&
                                     is_near(w.to, g.to);
                            }))
        << g.level << ": " << g.from.x << " " << g.from.y << " to " << g.to.x << " " << g.to.y;
  }
}

/// Lines are joined, rings that lie inside stay rings, and what ends where the whole terrain's does
/// not ends on the polygon's border.
void expect_joined(const Isolines& got, const Isolines& whole, const Polygon& polygon) {
  std::set<std::array<double, 2>> ends;
  std::multiset<std::vector<std::array<double, 2>>> rings_inside, rings;
  const auto sorted = [](std::span<const MapPoint> points) {
    std::vector<std::array<double, 2>> all;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) all.push_back({points[i].x, points[i].y});
    std::sort(all.begin(), all.end());
    return all;
  };
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const Isoline line = whole.line(i, points);
    if (!line.ring) {
      for (const MapPoint p : {points.front(), points.back()}) ends.insert({p.x, p.y});
      continue;
    }
    bool is_inside = true;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const auto in = stretches_in(polygon, points[k], points[k + 1]);
      is_inside = is_inside && in.size() == 1 && in[0].from == 0 && in[0].to == 1;
    }
    if (is_inside) rings_inside.insert(sorted(points));
  }
  for (std::size_t i = 0; i < got.size(); ++i) {
    const Isoline line = got.line(i, points);
    ASSERT_GE(points.size(), 2u);
    if (line.ring) {
      EXPECT_EQ(points.front(), points.back());
      rings.insert(sorted(points));
      continue;
    }
    for (const MapPoint p : {points.front(), points.back()}) {
      if (ends.contains({p.x, p.y})) continue;
      EXPECT_LE(distance_to_border(polygon, p), kRounding) << p.x << " " << p.y;
    }
  }
  EXPECT_EQ(rings, rings_inside);
}

TEST(Isolines, OfAPolygonAreThoseOfTheTerrainCut) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Hierarchy h = reference::small_terrain(seed);
    const TemporaryStore store(h);
    const Terrain terrain(store.open());
    IsolineRequest request;
    request.levels = reference::random_levels(random, h, 5);
    if (seed % 2 == 0) request.detail.tolerance = 0.5 * double(seed % 7);
    const Isolines whole = isolines(terrain, request);
    const Polygon polygon = any_polygon(random, h.facts);
    request.region = polygon;
    for (const AnswerBy by : {AnswerBy::kStars, AnswerBy::kSplits}) {
      const Isolines got = terrain.isolines(request, by);
      expect_same(stretches_of(got), cut_in_rationals(stretches_of(whole), polygon));
      expect_joined(got, whole, polygon);
      EXPECT_EQ(got.certified_error, whole.certified_error);
    }
  }
}

/// A rectangle off the grid, told as a polygon from any corner and either way round.
TEST(Isolines, OfARectangleAreThoseOfItsWindowToTheBit) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  const GridBox& b = facts.bounds;
  const MapPoint low = facts.map.to_map(b.min_x + 33.3, b.min_y + 20.7);
  const MapPoint high = facts.map.to_map(b.min_x + 200.1, b.min_y + 177.9);
  std::vector<MapPoint> ring = {low, {high.x, low.y}, high, {low.x, high.y}};
  IsolineRequest request;
  request.levels = {20, 50.5, 100, 200};
  request.region = Window{low.x, low.y, high.x, high.y};
  const reference::Listing window = listing(isolines(terrain, request));
  EXPECT_GT(window.size(), 5u);
  request.region = Polygon{{ring}};
  EXPECT_EQ(listing(isolines(terrain, request)), window);
  std::rotate(ring.begin(), ring.begin() + 1, ring.end());
  std::reverse(ring.begin(), ring.end());
  ring.push_back(ring.front());
  request.region = Polygon{{ring}};
  EXPECT_EQ(listing(isolines(terrain, request)), window);
}

/// Where lines end on a slanted side that two polygons share.
TEST(Isolines, OfTwoPolygonsMeetInTheSameBits) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  const GridBox& b = facts.bounds;
  const auto at = [&](double x, double y) {
    return facts.map.to_map(b.min_x + x * (b.max_x - b.min_x), b.min_y + y * (b.max_y - b.min_y));
  };
  const MapPoint p = at(0.13, 0.21), q = at(0.87, 0.68);
  const auto ends = [&](const Polygon& polygon) {
    IsolineRequest request;
    request.levels = {800, 1000, 1234.5};
    request.region = polygon;
    const Isolines lines = isolines(terrain, request);
    std::multiset<std::array<double, 3>> all;
    std::vector<MapPoint> points;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Isoline line = lines.line(i, points);
      for (const MapPoint& end : {points.front(), points.back()}) {
        const double off = ((q.x - p.x) * (end.y - p.y) - (q.y - p.y) * (end.x - p.x)) /
                           std::hypot(q.x - p.x, q.y - p.y);
        if (!line.ring && std::abs(off) < 1e-6)
          all.insert({lines.levels()[line.level], end.x, end.y});
      }
    }
    return all;
  };
  const auto one = ends({{{p, q, at(0.2, 0.9)}}}), other = ends({{{at(0.9, 0.1), q, p}}});
  EXPECT_GT(one.size(), 10u);
  EXPECT_EQ(one, other);
}

TEST(Isolines, OfAPlaceWithoutInsideAreRefused) {
  const TemporaryStore store(reference::small_terrain(1));
  const OpenedTerrain terrain(store.open());
  IsolineRequest request;
  request.levels = {1.0};
  request.region = MapPoint{1000, -500};
  EXPECT_THROW(static_cast<void>(isolines(terrain, request)), Error);
  request.region = Polygon{};
  EXPECT_THROW(static_cast<void>(isolines(terrain, request)), Error);
}

}  // namespace
}  // namespace ptin
