// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes against all triangles, in rationals; and their bounds against the full TIN.
#include "engine/query/volume/volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "engine/crs/border_move.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/query/volume/volume_oracle.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::Rational;
using reference::rational_triangles;
using reference::RationalVolume;
using reference::TemporaryStore;
using Rings = std::vector<std::vector<MapPoint>>;

/// @param rounding  What the result says of itself; sums and the last steps round a little more.
void expect_near(double got, const Rational& exact, double rounding, const char* what) {
  const double want = exact.convert_to<double>();
  EXPECT_LE(std::abs(got - want), rounding + 1e-14 * std::abs(want)) << what << " " << want;
}

void check(const VolumeResult& got, const RationalVolume& want) {
  expect_near(got.cut.value, want.cut, got.rounding, "cut");
  expect_near(got.fill.value, want.fill, got.rounding, "fill");
  expect_near(got.net.value, want.cut - want.fill, 2 * got.rounding, "net");
  const double of_areas = 1e-12 * (1 + got.surface_area + got.void_area);
  expect_near(got.surface_area, want.surface_area, of_areas, "surface");
  expect_near(got.void_area, want.void_area, of_areas, "void");
  EXPECT_LE(got.rounding, 1e-9 * (1 + got.cut.value + got.fill.value));
  EXPECT_LE(got.cut_area + got.fill_area, got.surface_area * (1 + 1e-12));
}

/// Whether the bounds hold a volume, which was computed in another way.
void expect_holds(const CertifiedVolume& bounds, double value, const char* what) {
  const double rounding = 1e-13 * std::abs(value);
  EXPECT_LE(bounds.low, value + rounding) << what;
  EXPECT_GE(bounds.high, value - rounding) << what;
  EXPECT_LE(bounds.low, bounds.value) << what;
  EXPECT_GE(bounds.high, bounds.value) << what;
}

void expect_holds(const VolumeResult& bounds, double cut, double fill) {
  expect_holds(bounds.cut, cut, "cut");
  expect_holds(bounds.fill, fill, "fill");
  expect_holds(bounds.net, cut - fill, "net");
}

/// A ring around the middle of a terrain that seldom keeps its distance.
std::vector<MapPoint> star(std::mt19937_64& random, const StoreFacts& facts, double size) {
  const GridBox& b = facts.bounds;
  const int corners = 3 + static_cast<int>(random() % 30);
  std::uniform_real_distribution<double> far(0.2, size);
  std::vector<MapPoint> ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const double r = far(random);
    const double x = (b.min_x + b.max_x) / 2.0 + r * (b.max_x - b.min_x) / 2.0 * std::cos(angle);
    const double y = (b.min_y + b.max_y) / 2.0 + r * (b.max_y - b.min_y) / 2.0 * std::sin(angle);
    ring.push_back(facts.map.to_map(x, y));
  }
  return ring;
}

/// A rectangle that has vertices on its sides, and often at its corners.
std::vector<MapPoint> rectangle(std::mt19937_64& random, const GridBox& b, const AffineMap& map) {
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
  };
  const int x = between(b.min_x, b.max_x), y = between(b.min_y, b.max_y);
  const int u = between(x, b.max_x + 1) + 1, v = between(y, b.max_y + 1) + 1;
  return {map.to_map(x, y), map.to_map(u, y), map.to_map(u, v), map.to_map(x, v)};
}

/// Nothing, a rectangle, a star, or a star with a hole in its core.
Rings random_rings(std::mt19937_64& random, const StoreFacts& facts) {
  if (random() % 4 == 0) return {};
  if (random() % 3 == 0) return {rectangle(random, facts.bounds, facts.map)};
  Rings rings = {star(random, facts, 1.2)};
  if (random() % 2 == 0) {
    const MapPoint m = facts.map.to_map((facts.bounds.min_x + facts.bounds.max_x) / 2.0,
                                        (facts.bounds.min_y + facts.bounds.max_y) / 2.0);
    std::vector<MapPoint> hole;  // the star about its middle, smaller
    for (const MapPoint p : rings[0]) hole.push_back({(p.x + m.x) / 2, (p.y + m.y) / 2});
    rings.push_back(hole);
  }
  return rings;
}

VolumeRequest request_for(const Rings& rings) {
  VolumeRequest request;
  if (!rings.empty()) request.region = Polygon{rings};
  return request;
}

double random_level(std::mt19937_64& random, const StoreFacts& facts) {
  if (facts.min_height > facts.max_height) return 0.0;
  std::uniform_real_distribution<double> level(facts.min_height - 1, facts.max_height + 1);
  return random() % 2 == 0 ? std::round(level(random)) : level(random);
}

/// As random_hierarchy(), so small that rationals are quick.
Hierarchy small_hierarchy(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto size = [&] { return 2 + static_cast<int>(random() % 6); };
  if (seed % 3 == 0) {
    return reference::simplify(reference::random_points(random, 10 + size() * 6, 40), random);
  }
  const int spacing = 1 + static_cast<int>(random() % 4);
  const double voids = seed % 3 == 1 ? 0.15 : 0.0;
  return reference::simplify(reference::random_grid(random, size(), size(), spacing, voids),
                             random);
}

TEST(Volume, OfALevelIsThatOfAllTriangles) {
  for (const std::uint64_t seed : test::some_of_first(12)) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Hierarchy h = small_hierarchy(seed);
    const TemporaryStore store(h);
    const OpenedTerrain terrain(store.open());
    const Rings rings = random_rings(random, h.facts);
    VolumeRequest request = request_for(rings);
    request.level = random_level(random, h.facts);
    const VolumeResult got = volume(terrain, request);
    check(got, volume_above(rational_triangles(h.full, h.facts), request.level, rings));
    EXPECT_TRUE(got.exact);
  }
}

/// A second terrain on a grid of its own, of about the same place.
Hierarchy other_hierarchy(std::uint64_t seed, std::mt19937_64& random, const StoreFacts& facts) {
  Hierarchy h = small_hierarchy(seed + 1000);
  if (random() % 3 == 0) return h;  // on the same grid
  const auto span = [](const GridBox& b) { return std::max(b.max_x - b.min_x, 1); };
  const double step = 0.5 * span(facts.bounds) / span(h.facts.bounds);
  h.facts.map = {1000.3, -500.7, step * 1.1, step * 0.9};
  return h;
}

TEST(Volume, OfAnOverlayIsThatOfAllPairs) {
  for (const std::uint64_t seed : test::some_of_first(6)) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Hierarchy a = small_hierarchy(seed);
    const Hierarchy b = other_hierarchy(seed, random, a.facts);
    const TemporaryStore store_a(a), store_b(b);
    const OpenedTerrain here(store_a.open()), there(store_b.open());
    const Rings rings = seed % 3 == 0 ? random_rings(random, a.facts) : Rings{};
    VolumeRequest request = request_for(rings);
    request.other = &there;
    const VolumeResult got = volume(here, request);
    const auto of_a = rational_triangles(a.full, a.facts),
               of_b = rational_triangles(b.full, b.facts);
    const RationalVolume want = volume_between(of_a, of_b, rings);
    check(got, want);
    const RationalVolume alone = volume_above(of_a, 0, rings), other = volume_above(of_b, 0, rings);
    const double rounding = 1e-11 * (1 + got.surface_area + got.void_area);
    expect_near(got.only_here_area, alone.surface_area - want.surface_area, rounding, "only here");
    expect_near(got.only_other_area, other.surface_area - want.surface_area, rounding,
                "only there");
  }
}

TEST(Volume, BetweenATerrainAndItselfIsNothing) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const TemporaryStore store(reference::random_hierarchy(seed));
    const OpenedTerrain terrain(store.open());
    VolumeRequest request;
    request.other = &terrain;
    const VolumeResult got = volume(terrain, request);
    EXPECT_EQ(got.cut.value, 0);
    EXPECT_EQ(got.fill.value, 0);
    EXPECT_EQ(got.only_here_area, 0);
    EXPECT_EQ(got.only_other_area, 0);
  }
}

std::vector<std::uint64_t> bits_of(const VolumeResult& r) {
  std::vector<std::uint64_t> bits;
  for (const CertifiedVolume& v : {r.cut, r.fill, r.net}) {
    for (const double x : {v.value, v.low, v.high}) bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  for (const double x : {r.rounding, r.cut_area, r.fill_area, r.surface_area, r.void_area,
                         r.only_here_area, r.only_other_area, r.mean_difference}) {
    bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  return bits;
}

VolumeRequest built_request(const OpenedTerrain& terrain) {
  VolumeRequest request;
  const Ground ground = ground_of(crs_facts(terrain.store()));
  request.ground = {ground.per_map_unit, !ground.geographic};
  request.border_move = border_moved_at_most;
  request.level = 300;
  return request;
}

MapPoint at(const OpenedTerrain& terrain, double x, double y) {
  const StoreFacts& facts = terrain.store().facts();
  return facts.map.to_map(facts.bounds.min_x + x * (facts.bounds.max_x - facts.bounds.min_x),
                          facts.bounds.min_y + y * (facts.bounds.max_y - facts.bounds.min_y));
}

TEST(Volume, IsTheSameForAnyMemoryTilesAndThreads) {
  const Terrain& coast = reference::built_terrain("coast_257.tif");
  const Terrain& rough = reference::built_terrain("coast_257.tif", 2.0);
  for (const OpenedTerrain* other : std::initializer_list<const OpenedTerrain*>{nullptr, &rough}) {
    VolumeRequest request = built_request(coast);
    request.other = other;
    request.detail.tolerance = 1.0;
    request.region = Polygon{{{at(coast, 0.1, 0.05), at(coast, 0.95, 0.3), at(coast, 0.4, 0.9)}}};
    const VolumeResult whole = volume(coast, request);
    request.limits.memory_bytes = std::uint64_t{4} << 20;
    const VolumeResult small = volume(coast, request);
    EXPECT_GT(small.tiles, whole.tiles);
    EXPECT_EQ(bits_of(small), bits_of(whole));
    request.limits = {};
    request.tile_bytes = 1 << 18;
    request.threads = 3;
    const VolumeResult threaded = volume(coast, request);
    EXPECT_GT(threaded.tiles, 10u);
    EXPECT_EQ(bits_of(threaded), bits_of(whole));
  }
}

/// Each of the levels, asked together, is what it is by itself, to the bit.
void expect_each_by_itself(const OpenedTerrain& terrain, VolumeRequest request,
                           const std::vector<double>& levels) {
  const std::vector<VolumeResult> all = volumes(terrain, request, levels);
  ASSERT_EQ(all.size(), levels.size());
  request.threads = 1;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    request.level = levels[i];
    const VolumeResult one = volume(terrain, request);
    EXPECT_EQ(bits_of(all[i]), bits_of(one)) << levels[i];
    EXPECT_EQ(all[i].exact, one.exact);
    EXPECT_EQ(all[i].certificate.error, one.certificate.error);
    EXPECT_EQ(all[i].certificate.deviation, one.certificate.deviation);
    EXPECT_EQ(all[i].border_move, one.border_move);
  }
}

/// A third of the coast is void, a third of it the sea, at 0.
TEST(Volume, OfSeveralLevelsIsThatOfEachByItself) {
  const Terrain& coast = reference::built_terrain("coast_257.tif");
  const Polygon part{{{at(coast, 0.1, 0.05), at(coast, 0.95, 0.3), at(coast, 0.4, 0.9)},
                      {at(coast, 0.4, 0.3), at(coast, 0.55, 0.35), at(coast, 0.42, 0.5)}}};
  const std::vector<double> levels = {33.3, 0.0, -10.0};
  VolumeRequest request = built_request(coast);
  request.threads = 2;
  request.tile_bytes = 1 << 18;
  EXPECT_GT(volume(coast, request).void_area, 0);
  expect_each_by_itself(coast, request, levels);
  request.region = part;
  expect_each_by_itself(coast, request, levels);
  for (const double tolerance : test::some_of({1.0, 20.0})) {
    request.detail.tolerance = tolerance;
    expect_each_by_itself(coast, request, levels);
  }
  request.region = std::nullopt;
  request.detail = {std::nullopt, 800};
  expect_each_by_itself(coast, request, levels);
}

TEST(Volume, OfSeveralLevelsIsThatOfEachOnRandomTerrains) {
  for (const std::uint64_t seed : test::some_of_first(24, 3)) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Hierarchy h = small_hierarchy(seed);
    const TemporaryStore store(h);
    const OpenedTerrain terrain(store.open());
    VolumeRequest request = request_for(random_rings(random, h.facts));
    if (seed % 2 == 0) request.detail.tolerance = 0.5 * static_cast<double>(seed % 7);
    if (seed % 4 == 0) {
      request.border_move = [](const StoreFile&, double certified_error) {
        return certified_error;
      };
    }
    std::vector<double> levels(50);
    for (double& level : levels) level = random_level(random, h.facts);
    expect_each_by_itself(terrain, request, levels);
  }
}

TEST(Volume, OfSeveralLevelsRefusesNoneAndThoseBesideATerrain) {
  const TemporaryStore store(small_hierarchy(1));
  const OpenedTerrain terrain(store.open());
  VolumeRequest request;
  const std::vector<double> two = {1.0, 2.0};
  EXPECT_THROW(static_cast<void>(volumes(terrain, request, {})), Error);
  EXPECT_THROW(static_cast<void>(volumes(terrain, request, std::vector<double>{1.0, NAN})), Error);
  request.limits.memory_bytes = 1 << 20;
  EXPECT_THROW(static_cast<void>(volumes(terrain, request, std::vector<double>(10'000, 1.0))),
               Error);
  request.other = &terrain;
  EXPECT_THROW(static_cast<void>(volumes(terrain, request, two)), Error);
}

TEST(Volume, OfTwoHalvesIsThatOfTheWhole) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  VolumeRequest request = built_request(terrain);
  request.level = 1000;
  const MapPoint a = at(terrain, 0.1, 0.2), b = at(terrain, 0.93, 0.13), c = at(terrain, 0.8, 0.9),
                 d = at(terrain, 0.2, 0.7);
  const auto of = [&](const Rings& rings) {
    request.region = Polygon{rings};
    return volume(terrain, request);
  };
  const VolumeResult whole = of({{a, b, c, d}}), one = of({{a, b, c}}), two = of({{c, d, a}});
  EXPECT_GT(whole.cut.value, 0);
  EXPECT_NEAR(one.cut.value + two.cut.value, whole.cut.value, whole.rounding * 3);
  EXPECT_NEAR(one.fill.value + two.fill.value, whole.fill.value, whole.rounding * 3);
  EXPECT_LT(whole.rounding, 1e-9 * whole.cut.value);
  // Even-odd: a bow tie has both of its halves, and a ring in a ring is a hole.
  const VolumeResult tie = of({{a, b, d, c}});
  EXPECT_LT(tie.surface_area, whole.surface_area);
  const VolumeResult twice = of({{a, b, c, d}, {a, b, c}});
  EXPECT_NEAR(twice.cut.value, two.cut.value, whole.rounding * 3);
}

/// With borders that move as far as the file's slope allows.
TEST(Volume, AtAnErrorHoldsThatOfTheFullTinWithVoids) {
  const Terrain& coast = reference::built_terrain("coast_257.tif");
  const Terrain& mountains = reference::built_terrain("mountains_257.tif");
  for (const Terrain* terrain : {&coast, &mountains}) {
    VolumeRequest request = built_request(*terrain);
    for (const bool is_part : {false, true}) {
      if (is_part) {
        const MapPoint low = at(*terrain, 0.3, 0.4), high = at(*terrain, 0.75, 0.85);
        request.region = Window{low.x, low.y, high.x, high.y};
      }
      request.detail = {};
      request.other = nullptr;
      const VolumeResult exact = volume(*terrain, request);
      double width = 0.0;
      for (const double tolerance : {0.5, 5.0, 40.0}) {
        request.detail.tolerance = tolerance;
        request.other = nullptr;
        const VolumeResult got = volume(*terrain, request);
        expect_holds(got, exact.cut.value, exact.fill.value);
        EXPECT_GT(got.net.high - got.net.low, width);
        width = got.net.high - got.net.low;
        // Against itself the volume of the full TINs is nothing.
        request.other = terrain;
        expect_holds(volume(*terrain, request), 0, 0);
      }
    }
  }
}

TEST(Volume, IsBoundedAtAnyLevelOfDetail) {
  std::mt19937_64 random(5);
  for (const char* name : {"coast_257.tif", "ground_points.csv"}) {
    SCOPED_TRACE(name);
    const Terrain& terrain = reference::built_terrain(name);
    for (int round = 0; round < 4; ++round) {
      VolumeRequest request = built_request(terrain);
      request.region = Polygon{random_rings(random, terrain.store().facts())};
      if (std::get<Polygon>(*request.region).rings.empty()) request.region = std::nullopt;
      request.level = random_level(random, terrain.store().facts());
      // Nothing may tell how far borders moved: then they may have gone anywhere.
      if (round % 2 == 0) request.border_move = nullptr;
      const VolumeResult exact = volume(terrain, request);
      request.detail.vertices = 200 + random() % 2000;
      const VolumeResult got = volume(terrain, request);
      expect_holds(got, exact.cut.value, exact.fill.value);
      EXPECT_FALSE(got.exact);
      const double all = (got.surface_area + got.void_area) * 1000;
      EXPECT_LT(got.cut.high, all);  // no height of either is larger
      EXPECT_GT(got.net.low, -all);
    }
  }
}

/// A window of a few samples has errors of one sign, and near a border ground of another class: here
/// bounds that are too narrow show.
TEST(Volume, IsBoundedInSmallWindows) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0.0, 0.97), size(0.004, 0.03);
  for (const char* name : {"coast_257.tif", "mountains_257.tif"}) {
    SCOPED_TRACE(name);
    const Terrain& terrain = reference::built_terrain(name);
    VolumeRequest request = built_request(terrain);
    int changed = 0;
    for (int round = 0; round < 150; ++round) {
      const double x = share(random), y = share(random);
      const MapPoint low = at(terrain, x, y),
                     high = at(terrain, x + size(random), y + size(random));
      request.region = Window{low.x, low.y, high.x, high.y};
      request.detail.tolerance = std::nullopt;
      request.level = random_level(random, terrain.store().facts());
      const VolumeResult exact = volume(terrain, request);
      request.detail.tolerance = 30.0;
      const VolumeResult got = volume(terrain, request);
      expect_holds(got, exact.cut.value, exact.fill.value);
      changed += std::abs(got.surface_area - exact.surface_area) > 1e-6 * got.surface_area;
    }
    EXPECT_EQ(changed > 0, !terrain.store().facts().free_of_voids);
  }
}

TEST(Volume, OfAFileThatLeftDetailOutIsBounded) {
  const Terrain& coast = reference::built_terrain("coast_257.tif");
  const Terrain& rough = reference::built_terrain("coast_257.tif", 2.0);
  VolumeRequest request = built_request(coast);
  const VolumeResult exact = volume(coast, request);
  EXPECT_TRUE(exact.exact);
  const VolumeResult bounded = volume(rough, request);
  EXPECT_FALSE(bounded.exact);
  EXPECT_GT(bounded.border_move, 0);
  expect_holds(bounded, exact.cut.value, exact.fill.value);
  EXPECT_LT(bounded.cut.high - bounded.cut.low, exact.cut.value);
}

TEST(Volume, OfVoidsIsNothing) {
  std::mt19937_64 random(3);
  const TemporaryStore store(
      reference::simplify(reference::random_grid(random, 5, 6, 1, 1.0), random));
  const OpenedTerrain terrain(store.open());
  VolumeRequest request;
  request.level = 5;
  request.detail.tolerance = 1.0;
  const VolumeResult got = volume(terrain, request);
  for (const CertifiedVolume& v : {got.cut, got.fill, got.net}) {
    EXPECT_EQ(v.low, 0);
    EXPECT_EQ(v.value, 0);
    EXPECT_EQ(v.high, 0);
  }
  EXPECT_EQ(got.surface_area, 0);
  EXPECT_EQ(got.void_area, 5.0);  // 4 x 5 cells of a quarter
  EXPECT_TRUE(std::isnan(got.mean_difference));
}

/// The area of a spheroid between two parallels and two meridians has a closed form.
TEST(Volume, OverDegreesIsThatOfTheEllipsoid) {
  const Terrain& coast = reference::built_terrain("coast_257.tif");
  VolumeRequest request = built_request(coast);
  request.level = -100;
  const VolumeResult got = volume(coast, request);
  const double a = 6378137.0, f = 1 / 298.257223563, e = std::sqrt(f * (2 - f));
  const auto zone = [&](double latitude) {  // per radian of longitude, from the equator
    const double s = std::sin(latitude * std::numbers::pi / 180);
    return a * a * (1 - e * e) / 2 * (s / (1 - e * e * s * s) + std::atanh(e * s) / e);
  };
  const MapPoint low = at(coast, 0, 0), high = at(coast, 1, 1);
  const double area = (high.x - low.x) * std::numbers::pi / 180 * (zone(high.y) - zone(low.y));
  EXPECT_NEAR(got.surface_area + got.void_area, area, 1e-10 * area);
}

TEST(Volume, RefusesWhatMeansNothing) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const auto refused = [&](const VolumeRequest& request) {
    try {
      static_cast<void>(volume(terrain, request));
    } catch (const Error& e) {
      return e.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  VolumeRequest request;
  request.level = NAN;
  EXPECT_TRUE(refused(request));
  request.level = 1e300;
  EXPECT_TRUE(refused(request));
  request.level = 0;
  request.other_height_scale = 0;
  EXPECT_TRUE(refused(request));
  request.other_height_scale = 1;
  request.region = at(terrain, 0.5, 0.5);
  EXPECT_TRUE(refused(request));
  request.region = std::nullopt;
  request.detail.tolerance = -1;
  EXPECT_TRUE(refused(request));
}

}  // namespace
}  // namespace ptin
