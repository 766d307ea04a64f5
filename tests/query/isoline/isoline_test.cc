// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines against brute force on the full TIN, as sets of segments; tiles, windows and tolerances
// against one another.
#include "engine/query/isoline/isoline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/isoline/isoline_clip.h"
#include "engine/query/questions.h"
#include "storage/page_columns.h"
#include "tests/query/isoline/isoline_listing.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::listing;
using reference::random_levels;
using reference::TemporaryStore;

/// Level, then from and to in map units.
using Piece = std::array<double, 5>;
using Pieces = std::multiset<Piece>;

double cross(MapPoint a, MapPoint b, MapPoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Every triangle by itself: cut its edges, and turn the piece so that a higher corner is on its
/// right.
Pieces brute_force(const Tin& tin, const StoreFacts& facts, const std::vector<double>& levels,
                   const Window* window = nullptr) {
  Pieces all;
  for (const double level : std::set<double>(levels.begin(), levels.end())) {
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (!tin.is_alive(t) || tin.classes[t] != TriangleClass::kSurface) continue;
      std::vector<MapPoint> cuts;
      MapPoint higher{};
      for (int i = 0; i < 3; ++i) {
        const Vertex& a = tin.vertices[tin.triangles[t].v[i]];
        const Vertex& b = tin.vertices[tin.triangles[t].v[(i + 1) % 3]];
        const double za = facts.heights.height(a.height);
        const double zb = facts.heights.height(b.height);
        if (za >= level) higher = facts.map.to_map(a.position.x, a.position.y);
        if ((za >= level) == (zb >= level)) continue;
        const Vertex& low = za < zb ? a : b;
        const Vertex& high = za < zb ? b : a;
        const MapPoint p = cut_of(
            {double(low.position.x), double(low.position.y), facts.heights.code(low.height)},
            {double(high.position.x), double(high.position.y), facts.heights.code(high.height)},
            (level - facts.heights.offset) / facts.heights.step);
        cuts.push_back(facts.map.to_map(p.x, p.y));
      }
      if (cuts.size() != 2 || cuts[0] == cuts[1]) continue;
      // At a level through corners the higher corner may lie on the line; then so do two of the
      // three, and the lower one tells.
      double side = cross(cuts[0], cuts[1], higher);
      for (const VertexId v : tin.triangles[t].v) {
        const MapPoint p = facts.map.to_map(tin.position(v).x, tin.position(v).y);
        const double s = cross(cuts[0], cuts[1], p);
        if (facts.heights.height(tin.vertices[v].height) < level && std::abs(s) > std::abs(side)) {
          side = -s;
        }
      }
      if (side > 0) std::swap(cuts[0], cuts[1]);
      if (window != nullptr) {
        const auto part = clip_segment(cuts[0], cuts[1], *window);
        if (!part) continue;
        cuts = {part->first, part->second};
      }
      all.insert({level, cuts[0].x, cuts[0].y, cuts[1].x, cuts[1].y});
    }
  }
  return all;
}

Pieces pieces_of(const Isolines& lines) {
  Pieces all;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    for (std::size_t k = 0; k + 1 < line.points.size(); ++k) {
      all.insert({lines.levels()[line.level], line.points[k].x, line.points[k].y,
                  line.points[k + 1].x, line.points[k + 1].y});
    }
  }
  return all;
}

Window isoline_window(std::mt19937_64& random, const StoreFacts& facts) {
  const auto coordinate = [&](std::int32_t low, std::int32_t high) {
    const double on_grid = low + double(random() % (std::uint64_t(high - low) + 1));
    return random() % 2 == 0 ? on_grid : on_grid + 0.37;
  };
  const GridBox& b = facts.bounds;
  const MapPoint p = facts.map.to_map(coordinate(b.min_x, b.max_x), coordinate(b.min_y, b.max_y));
  const MapPoint q = facts.map.to_map(coordinate(b.min_x, b.max_x), coordinate(b.min_y, b.max_y));
  return {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
}

/// The surface triangles around each edge; an edge with one is a border.
bool lies_on_border(const Hierarchy& h, MapPoint p) {
  for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
    const Triangle& triangle = h.full.triangles[t];
    if (h.full.classes[t] != TriangleClass::kSurface) continue;
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = triangle.n[i];
      if (n != kNone && h.full.classes[n] == TriangleClass::kSurface) continue;
      const GridPoint a = h.full.position(triangle.v[next_corner(i)]);
      const GridPoint b = h.full.position(triangle.v[previous_corner(i)]);
      const MapPoint pa = h.facts.map.to_map(a.x, a.y);
      const MapPoint pb = h.facts.map.to_map(b.x, b.y);
      const double length2 = (pb.x - pa.x) * (pb.x - pa.x) + (pb.y - pa.y) * (pb.y - pa.y);
      const double along = ((p.x - pa.x) * (pb.x - pa.x) + (p.y - pa.y) * (pb.y - pa.y)) / length2;
      if (along > -1e-9 && along < 1 + 1e-9 && std::abs(cross(pa, pb, p)) <= 1e-6 * length2) {
        return true;
      }
    }
  }
  return false;
}

RC_GTEST_PROP(Isolines, AreTheBruteForceOnesOfTheFullTin, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 3; ++i) {
    IsolineRequest request;
    request.levels = random_levels(random, h, 1 + static_cast<int>(random() % 6));
    const Isolines lines = isolines(terrain, request);
    RC_ASSERT(pieces_of(lines) == brute_force(h.full, h.facts, request.levels));
    RC_ASSERT(lines.exact);
  }
}

RC_GTEST_PROP(Isolines, EndOnlyWhereTheSurfaceEnds, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  std::mt19937_64 random(seed);
  IsolineRequest request;
  request.levels = random_levels(random, h, 4);
  const Isolines lines = isolines(Terrain(file.open()), request);
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    RC_ASSERT(line.points.size() >= 2U);
    RC_ASSERT(!line.ring || line.points.front() == line.points.back());
    if (!line.ring) {
      RC_ASSERT(lies_on_border(h, line.points.front()));
      RC_ASSERT(lies_on_border(h, line.points.back()));
    }
  }
}

RC_GTEST_PROP(Isolines, AtALevelOfDetailAreThoseOfItsTin, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  RC_PRE(!h.records.empty());
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  RefineRequest whole;
  if (random() % 2 == 0) {
    whole.detail.tolerance =
        h.records[random() % h.records.size()].error * (random() % 2 == 0 ? 1.0 : 0.5);
  } else {
    whole.detail.vertices = h.t0.vertices.size() + random() % (h.records.size() + 2);
  }
  IsolineRequest request;
  request.levels = random_levels(random, h, 3);
  request.detail.tolerance = whole.detail.tolerance;
  request.detail.vertices = whole.detail.vertices;
  const Isolines lines = isolines(terrain, request);
  const RefinedTin refined = terrain.refine(whole);
  RC_ASSERT(pieces_of(lines) == brute_force(refined.tin, h.facts, request.levels));
  // Of a number of vertices up to the end of a bin of errors.
  RC_ASSERT(lines.certified_error >= refined.certified_error);
  RC_ASSERT(lines.certified_deviation >= refined.certified_deviation);
  RC_ASSERT(lines.exact == refined.exact);
  if (whole.detail.tolerance) RC_ASSERT(lines.certified_error <= *whole.detail.tolerance);
}

RC_GTEST_PROP(Isolines, OfAWindowAreThoseOfTheTerrainCut, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 4; ++i) {
    IsolineRequest request;
    request.levels = random_levels(random, h, 3);
    request.region = isoline_window(random, h.facts);
    RC_ASSERT(pieces_of(isolines(terrain, request)) ==
              brute_force(h.full, h.facts, request.levels, &std::get<Window>(*request.region)));
  }
}

/// Ends of lines on x == at, by level.
std::multiset<std::array<double, 3>> ends_at(const Isolines& lines, double at) {
  std::multiset<std::array<double, 3>> ends;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    for (const MapPoint& p : {line.points.front(), line.points.back()}) {
      if (!line.ring && p.x == at) ends.insert({lines.levels()[line.level], p.x, p.y});
    }
  }
  return ends;
}

RC_GTEST_PROP(Isolines, OfTwoWindowsMeetInTheSameBits, (std::uint64_t seed)) {
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::mt19937_64 random(seed);
  IsolineRequest request;
  request.levels = random_levels(random, h, 4);
  const GridBox& b = h.facts.bounds;
  // Between grid lines, and off every vertex: no line runs along the side or touches it.
  const double x = b.min_x + double(random() % std::uint64_t(b.max_x - b.min_x)) + 0.123456789;
  const double side = h.facts.map.to_map(x, 0).x;
  const MapPoint low = h.facts.map.to_map(b.min_x - 1, b.min_y - 1);
  const MapPoint high = h.facts.map.to_map(b.max_x + 1, b.max_y + 1);
  request.region = Window{low.x, low.y, side, high.y};
  const Isolines left = isolines(terrain, request);
  request.region = Window{side, low.y, high.x, high.y};
  const Isolines right = isolines(terrain, request);
  RC_ASSERT(ends_at(left, side) == ends_at(right, side));
}

/// A raster that takes several tiles, with voids, plateaus and saddles at whole heights.
struct LargeTerrain {
  LargeTerrain() : hierarchy(make()), file(hierarchy), tin(file.open()) {}
  static Hierarchy make() {
    std::mt19937_64 random(7);
    Tin full = reference::random_grid(random, 70, 60, 8, 0.05);
    return reference::simplify_unmeasured(std::move(full), random);
  }
  Hierarchy hierarchy;
  TemporaryStore file;
  Terrain tin;
};

TEST(Isolines, DoNotDependOnTilesOrTemporaryFiles) {
  const LargeTerrain terrain;
  std::mt19937_64 random(3);
  IsolineRequest request;
  request.levels = random_levels(random, terrain.hierarchy, 20);
  request.counts_vertices = true;
  const Isolines whole = isolines(terrain.tin, request);
  EXPECT_EQ(whole.tiles, 1U);
  EXPECT_GT(whole.crossed.vertices, 0U);
  request.limits.memory_bytes = 2 << 20;
  request.temporary_folder = std::filesystem::temp_directory_path().string();
  const Isolines tiled = isolines(terrain.tin, request);
  EXPECT_GT(tiled.tiles, 1U);
  EXPECT_GT(tiled.points() * sizeof(MapPoint), request.limits.memory_bytes / 8);
  EXPECT_EQ(tiled.crossed.segments, whole.crossed.segments);
  EXPECT_EQ(tiled.crossed.vertices, whole.crossed.vertices);
  EXPECT_TRUE(listing(whole) == listing(tiled));
  EXPECT_TRUE(pieces_of(whole) ==
              brute_force(terrain.hierarchy.full, terrain.hierarchy.facts, request.levels));
  request.threads = 3;
  request.limits.memory_bytes = 64 << 20;  // enough for each
  EXPECT_TRUE(listing(whole) == listing(isolines(terrain.tin, request)));
  // Without a folder points have three eighths of the memory, where no line is cut.
  request.temporary_folder.clear();
  request.limits.memory_bytes = 2 << 20;
  ASSERT_LT(whole.points() * sizeof(MapPoint), request.limits.memory_bytes / 8 * 3);
  EXPECT_TRUE(listing(whole) == listing(isolines(terrain.tin, request)));
  request.levels = random_levels(random, terrain.hierarchy, 28);
  request.limits.memory_bytes = 1 << 20;
  try {
    static_cast<void>(isolines(terrain.tin, request));
    ADD_FAILURE() << "was not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource_exhausted) << error.message();
  }
}

/// What is crossed does not fit though the records do: tiles are halved for it, and when that does
/// not help the refusal says so in one sentence, before anything is handed out.
TEST(Isolines, FitTheirMemoryWhateverIsCrossedOrAreRefused) {
  const LargeTerrain terrain;
  const StoreFacts& facts = terrain.hierarchy.facts;
  IsolineRequest request;
  const double step = (facts.max_height - facts.min_height) / 60;
  for (int i = 0; i < 60; ++i) request.levels.push_back(facts.min_height + (i + 0.5) * step);
  const Isolines whole = isolines(terrain.tin, request);
  request.temporary_folder = std::filesystem::temp_directory_path().string();
  request.limits.memory_bytes = 8 << 20;
  const Isolines tiled = isolines(terrain.tin, request);
  EXPECT_GT(tiled.tiles, 1U);
  EXPECT_TRUE(listing(whole) == listing(tiled));
  for (const std::uint64_t limit : {std::uint64_t{1} << 20, std::uint64_t{3} << 19}) {
    request.limits.memory_bytes = limit;
    try {
      static_cast<void>(isolines(terrain.tin, request));
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::resource_exhausted);
      EXPECT_NE(error.message().find("give more memory"), std::string::npos) << error.message();
    }
  }
}

TEST(Isolines, AreCountedBeforeTheyAreHandedOut) {
  const LargeTerrain terrain;
  std::mt19937_64 random(3);
  IsolineRequest request;
  request.levels = random_levels(random, terrain.hierarchy, 5);
  const std::size_t lines = isolines(terrain.tin, request).size();
  request.most_lines = lines;
  EXPECT_EQ(isolines(terrain.tin, request).size(), lines);
  request.most_lines = lines - 1;
  try {
    static_cast<void>(isolines(terrain.tin, request));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(error.message().find(std::to_string(lines) + " isolines"), std::string::npos);
  }
}

TEST(Isolines, RefuseLevelsThatMeanNothing) {
  const LargeTerrain terrain;
  IsolineRequest request;
  EXPECT_THROW(static_cast<void>(isolines(terrain.tin, request)), Error);
  request.levels = {std::nan("")};
  EXPECT_THROW(static_cast<void>(isolines(terrain.tin, request)), Error);
  request.levels = {1.0};
  request.detail.tolerance = -1.0;
  EXPECT_THROW(static_cast<void>(isolines(terrain.tin, request)), Error);
  std::stop_source stop;
  stop.request_stop();
  request.detail.tolerance.reset();
  request.limits.stop = stop.get_token();
  EXPECT_THROW(static_cast<void>(isolines(terrain.tin, request)), Error);
}

TEST(Levels, AreStoredHeightsWhereTheyAreMeant) {
  const HeightEncoding centimetres{HeightType::int32, 0.01, 100.0};
  const LevelSet levels({254.97, 254.97, 254.975, 100.0}, centimetres);
  ASSERT_EQ(levels.size(), 3U);
  EXPECT_EQ(levels.code(0), 0.0);
  EXPECT_EQ(levels.code(1), 15497.0);
  EXPECT_EQ(levels.height(1), 254.97);
  EXPECT_EQ(levels.band_of(15497.0), 2U);
  EXPECT_EQ(levels.band_of(15496.0), 1U);
  EXPECT_EQ(levels.band_of(-1.0), 0U);
}

/// What is above a level by its code is so as an ordered number too.
RC_GTEST_PROP(Levels, LieBetweenOrderedHeights, (bool are_whole, std::vector<int> numbers)) {
  const HeightEncoding heights{are_whole ? HeightType::int32 : HeightType::float32, 1.0, 0.0};
  std::vector<double> given{-1e300, 1e300, -0.0, 1e-300, -1e-300, 0.1, 2147483647.0, 2147483647.5};
  std::vector<HeightBits> stored{heights.bits(-0.0), heights.bits(2147483647.0)};
  for (const int n : numbers) {
    given.push_back(n + *rc::gen::element(0.0, 0.5, 1e-9, -1e-9));
    stored.push_back(heights.bits(n));
    stored.push_back(heights.bits(n / 3.0));
  }
  const LevelSet levels(given, heights);
  RC_ASSERT(levels.least_above().size() == levels.size());
  for (const HeightBits bits : stored) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const bool is_above = ordered_height(bits, heights.type) >= levels.least_above(i);
      RC_ASSERT(is_above == (levels.band_of(heights.code(bits)) > i));
    }
  }
}

TEST(Levels, LadderCountsWhatLiesAtOrBelow) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> anywhere(-1e4, 1e4);
  for (int round = 0; round < 200; ++round) {
    std::set<double> steps;
    const double scale = std::pow(10.0, double(random() % 24) - 20);
    for (std::size_t i = 0; i <= random() % 40; ++i) {
      steps.insert(anywhere(random) * (i % 3 == 0 ? scale : 1));
    }
    const std::vector<double> sorted(steps.begin(), steps.end());
    const Ladder ladder(sorted);
    std::vector<double> asked = {-HUGE_VAL, HUGE_VAL, 0, 1e300, -1e300};
    for (int i = 0; i < 200; ++i) asked.push_back(anywhere(random) * (i % 2 == 0 ? scale : 1));
    for (const double s : sorted) {
      asked.insert(asked.end(), {s, std::nextafter(s, -HUGE_VAL), std::nextafter(s, HUGE_VAL)});
    }
    for (const double v : asked) {
      ASSERT_EQ(ladder.at_or_below(v),
                std::upper_bound(sorted.begin(), sorted.end(), v) - sorted.begin())
          << v;
    }
  }
}

TEST(Levels, AtAnIntervalAreThoseOfTheBase) {
  EXPECT_EQ(levels_at(10, 3, 0, 40), (std::vector<double>{3, 13, 23, 33}));
  EXPECT_EQ(levels_at(10, 0, -20, 0), (std::vector<double>{-20, -10, 0}));
  EXPECT_TRUE(levels_at(10, 0, 5, -5).empty());
  EXPECT_THROW(static_cast<void>(levels_at(0, 0, 0, 1)), Error);
  EXPECT_THROW(static_cast<void>(levels_at(1e-9, 0, 0, 1)), Error);
  EXPECT_TRUE(levels_at(10, 0, kInfinity, -kInfinity).empty());
  // Where n + 1 is n, or the heights are none: refused, not counted for ever.
  EXPECT_THROW(static_cast<void>(levels_at(1, 1e17, 0, 100)), Error);
  EXPECT_THROW(static_cast<void>(levels_at(1, -1e17, 0, 100)), Error);
  EXPECT_THROW(static_cast<void>(levels_at(1, 0, 1e30, 1e30)), Error);
  EXPECT_THROW(static_cast<void>(levels_at(1, 0, -kInfinity, kInfinity)), Error);
  EXPECT_THROW(static_cast<void>(levels_at(1, 0, 0, kInfinity)), Error);
}

TEST(ClipLine, KeepsRingsAndJoinsThePartThatHoldsTheirFirstPoint) {
  const std::vector<MapPoint> ring{{1, 1}, {3, 1}, {3, 3}, {1, 3}, {1, 1}};
  EXPECT_TRUE(clip_line(ring, {0, 0, 4, 4}).whole);
  const ClippedParts parts = clip_line(ring, {0, 0, 2, 4});
  ASSERT_EQ(parts.parts.size(), 1U);
  EXPECT_EQ(parts.parts[0], (std::vector<MapPoint>{{2, 3}, {1, 3}, {1, 1}, {2, 1}}));
  EXPECT_TRUE(clip_line(ring, {3, 4, 5, 6}).parts.empty());
  EXPECT_EQ(clip_line(ring, {3, 0, 5, 6}).parts.size(), 1U) << "along the side";
}

}  // namespace
}  // namespace ptin
