// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first t vertices of the total order: exactly N, for every N (engine/DESIGN.md, section 2.6).
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/heights/locate.h"
#include "engine/query/heights/profile.h"
#include "engine/query/questions.h"
#include "engine/query/select/detail.h"
#include "tests/query/line_oracle.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

/// Keys of the first `count` records in the total order, by sorting all of them.
std::set<VertexKey> first_by_sorting(std::vector<VertexSplit> records, std::size_t count) {
  std::sort(records.begin(), records.end(), [](const VertexSplit& a, const VertexSplit& b) {
    return std::tuple(-a.error, -int{a.rank}, key_of(a.u)) <
           std::tuple(-b.error, -int{b.rank}, key_of(b.u));
  });
  std::set<VertexKey> keys;
  for (std::size_t i = 0; i < std::min(count, records.size()); ++i) {
    keys.insert(key_of(records[i].u));
  }
  return keys;
}

std::set<VertexKey> keys_beyond_t0(const RefinedTin& result) {
  std::set<VertexKey> keys;
  for (VertexId v = static_cast<VertexId>(result.t0_vertices); v < result.tin.vertices.size();
       ++v) {
    keys.insert(key_of(result.tin.position(v)));
  }
  return keys;
}

/// Of the records that are not among those taken; 0 where all are.
double largest_error_left(const std::vector<VertexSplit>& records,
                          const std::set<VertexKey>& taken) {
  double left = 0.0;
  for (const VertexSplit& r : records) {
    if (!taken.contains(key_of(r.u))) left = std::max<double>(left, r.error);
  }
  return left;
}

TEST(RefineToVertexCount, GivesExactlyThatManyForEveryCount) {
  for (std::uint64_t seed = 10; seed < 22; ++seed) {
    const reference::Hierarchy h = reference::random_hierarchy(seed);
    const reference::TemporaryStore file(h);
    const Terrain tin(file.open());
    const std::size_t t0 = h.t0.vertices.size();
    for (std::size_t n = t0; n <= t0 + h.records.size(); ++n) {
      RefineRequest request;
      request.detail.vertices = n;
      const RefinedTin result = tin.refine(request);
      ASSERT_EQ(result.vertices, n) << "seed " << seed;
      ASSERT_EQ(validate(result.tin), "") << "seed " << seed << ", " << n << " vertices";
      const std::set<VertexKey> taken = keys_beyond_t0(result);
      ASSERT_EQ(taken, first_by_sorting(h.records, n - t0)) << "seed " << seed;
      const double left = largest_error_left(h.records, taken);
      ASSERT_GE(result.certified_error, left) << "seed " << seed << ", " << n << " vertices";
      ASSERT_LE(result.certified_error, left * 1.125)
          << "seed " << seed << ", " << n << " vertices";
    }
  }
}

TEST(RefineToVertexCount, AboveAllThereAreGivesTheFullTin) {
  const reference::Hierarchy h = reference::random_hierarchy(4);
  const reference::TemporaryStore file(h);
  RefineRequest request;
  request.detail.vertices = UINT64_MAX;
  const RefinedTin result = Terrain(file.open()).refine(request);
  EXPECT_TRUE(result.exact);
  EXPECT_EQ(result.vertices, h.full.vertices.size());
  EXPECT_EQ(result.certified_error, 0.0);
}

TEST(RefineToTriangleCount, GivesAsManyOrOneLessForEveryCount) {
  for (std::uint64_t seed = 10; seed < 18; ++seed) {
    const reference::Hierarchy h = reference::random_hierarchy(seed);
    const reference::TemporaryStore file(h);
    const Terrain tin(file.open());
    const std::size_t all = h.full.triangles.size();
    std::uint64_t vertices = h.t0.vertices.size();
    for (std::size_t n = h.t0.triangles.size(); n <= all + 3; ++n) {
      RefineRequest request;
      request.triangles = n;
      const RefinedTin result = tin.refine(request);
      ASSERT_EQ(validate(result.tin), "") << "seed " << seed << ", " << n << " triangles";
      ASSERT_LE(result.triangles, n) << "seed " << seed;
      ASSERT_GE(result.triangles + 1, std::min(n, all)) << "seed " << seed;
      ASSERT_GE(result.vertices, vertices) << "seed " << seed << ": levels are nested";
      vertices = result.vertices;
      // The TIN of the same number of vertices, and one vertex more is too many.
      request.triangles.reset();
      request.detail.vertices = vertices;
      const RefinedTin same = tin.refine(request);
      const std::set<VertexKey> taken = keys_beyond_t0(result);
      ASSERT_EQ(taken, keys_beyond_t0(same)) << "seed " << seed;
      const double left = largest_error_left(h.records, taken);
      ASSERT_GE(result.certified_error, left) << "seed " << seed << ", " << n << " triangles";
      ASSERT_LE(result.certified_error, left * 1.125) << "seed " << seed << ", " << n;
      ASSERT_EQ(result.exact, same.exact) << "seed " << seed;
      request.detail.vertices = vertices + 1;
      ASSERT_TRUE(n >= all || tin.refine(request).triangles > n) << "seed " << seed << ", " << n;
    }
    EXPECT_EQ(vertices, h.full.vertices.size());
  }
}

RC_GTEST_PROP(RefineToTriangleCount, WithinARegionIsThatOfTheSameNumberOfVertices,
              (std::uint64_t seed)) {
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const Terrain tin(file.open());
  std::mt19937_64 random(seed);
  RefineRequest request;
  request.region = reference::random_region(random, h.facts);
  request.triangles = h.t0.triangles.size() + random() % (2 * h.records.size() + 3);
  const RefinedTin result = tin.refine(request);
  const std::uint64_t most = *request.triangles;
  RC_ASSERT(result.triangles <= most);
  request.detail.vertices = result.vertices;
  request.triangles.reset();
  RC_ASSERT(keys_beyond_t0(result) == keys_beyond_t0(tin.refine(request)));
  request.detail.vertices = result.vertices + 1;
  const RefinedTin more = tin.refine(request);
  RC_ASSERT(more.vertices == result.vertices || more.triangles > most);
}

TEST(RefineToTriangleCount, ReadsLittleMoreThanThePagesItNeeds) {
  std::mt19937_64 random(1);
  const reference::Hierarchy h =
      reference::simplify(reference::random_grid(random, 160, 160, 1, 0.0), random, {0.0, false});
  const reference::TemporaryStore file(h, 4096, 1);
  RefineRequest request;
  request.triangles = h.t0.triangles.size() + 2000;
  const RefinedTin some = Terrain(file.open()).refine(request);
  EXPECT_GE(some.triangles + 1, *request.triangles);
  EXPECT_LT(some.cost.io.pages, 3 * 1000 / 56 + 20);
}

TEST(RefineToTriangleCount, SaysWhatMeansNothing) {
  const reference::Hierarchy h = reference::random_hierarchy(3);
  const reference::TemporaryStore file(h);
  const Terrain tin(file.open());
  RefineRequest request;
  request.triangles = h.t0.triangles.size() - 1;
  EXPECT_THROW(static_cast<void>(tin.refine(request)), Error);
  request.triangles = h.t0.triangles.size();
  EXPECT_EQ(tin.refine(request).vertices, h.t0.vertices.size());
  request.detail.tolerance = 1.0;
  EXPECT_THROW(static_cast<void>(tin.refine(request)), Error);
  request.detail.tolerance.reset();
  request.detail.vertices = h.full.vertices.size();
  EXPECT_THROW(static_cast<void>(tin.refine(request)), Error);
}

RC_GTEST_PROP(RefineToVertexCount, WithinARegionTakesItsMostImportantRecords,
              (std::uint64_t seed)) {
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const Terrain tin(file.open());
  std::mt19937_64 random(seed);
  RefineRequest request;
  request.region = reference::random_region(random, h.facts);
  const GridRegion region(*request.region, h.facts.map);
  std::vector<VertexSplit> inside;
  std::copy_if(h.records.begin(), h.records.end(), std::back_inserter(inside),
               [&](const VertexSplit& r) { return region.meets(r.roi); });
  const std::size_t count = random() % (inside.size() + 3);
  request.detail.vertices = h.t0.vertices.size() + count;
  const RefinedTin result = tin.refine(request);
  RC_ASSERT(validate(result.tin).empty());
  RC_ASSERT(keys_beyond_t0(result) == first_by_sorting(inside, count));
  RC_ASSERT(!result.exact || count >= inside.size());
  RC_ASSERT(result.exact || count <= inside.size());
}

TEST(RefineToVertexCount, ReadsLittleMoreThanThePagesItNeeds) {
  std::mt19937_64 random(1);
  const reference::Hierarchy h =
      reference::simplify(reference::random_grid(random, 160, 160, 1, 0.0), random, {0.0, false});
  const reference::TemporaryStore file(h, 4096, 1);
  const Terrain tin(file.open());
  RefineRequest request;
  request.detail.vertices = h.t0.vertices.size() + 1000;
  const RefinedTin some = tin.refine(request);
  EXPECT_EQ(some.vertices, *request.detail.vertices);
  EXPECT_LT(some.cost.io.pages, 3 * 1000 / 56 + 20);
}

/// The TIN of the first `vertices` vertices of the whole terrain.
RefinedTin first_vertices(const Terrain& terrain, std::uint64_t vertices) {
  RefineRequest request;
  request.detail.vertices = vertices;
  return terrain.refine(request);
}

/// Heights on that TIN at a spot, of every surface triangle that holds it.
std::vector<double> heights_at(const Tin& tin, const StoreFacts& facts, Spot spot) {
  std::vector<double> heights;
  for (const TriangleId t : reference::triangles_at(tin, reference::rational_of(spot))) {
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    const auto code = reference::code_on(tin, facts.heights, t, reference::rational_of(spot));
    heights.push_back(facts.heights.height_of_code(code.convert_to<double>()));
  }
  return heights;
}

void check_height(double height, const std::vector<double>& wanted) {
  RC_ASSERT(std::isnan(height) == wanted.empty());
  if (!wanted.empty()) RC_ASSERT(std::abs(height - wanted.front()) < 1e-9);
}

RC_GTEST_PROP(FirstVertices, PointsAndProfilesAreThoseOfTheTinOfThatManyVertices,
              (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  const std::uint64_t count = h.t0.vertices.size() + random() % (h.records.size() + 3);
  const RefinedTin wanted = first_vertices(terrain, count);
  std::vector<Spot> spots;
  std::vector<MapPoint> points;
  while (spots.size() < 12) {
    const Spot s = reference::nasty_spot(random, h.full);
    if (!spots.empty() && spots.back() == s) continue;
    spots.push_back(s);
    points.push_back(map.map(s));
  }
  LocateRequest locating;
  locating.detail.vertices = count;
  const LocateResult found = locate(terrain, points, locating);
  RC_ASSERT(found.exact == wanted.exact);
  const double left = largest_error_left(h.records, keys_beyond_t0(wanted));
  RC_ASSERT(found.certified_error >= left);
  RC_ASSERT(found.certified_error <= left * 1.125);
  for (std::size_t i = 0; i < spots.size(); ++i) {
    check_height(found.points[i].height, heights_at(wanted.tin, h.facts, spots[i]));
  }
  ProfileRequest walking;
  walking.detail.vertices = count;
  const ProfileResult line = profile(terrain, points, walking);
  RC_ASSERT(line.certified_deviation == found.certified_deviation);
  std::size_t stops = 0;
  for (std::size_t i = 0; i + 1 < spots.size(); ++i) {
    auto shares = reference::stops(wanted.tin, reference::rational_of(spots[i]),
                                   reference::rational_of(spots[i + 1]));
    shares.insert(0);
    shares.insert(1);
    stops += shares.size() - 1;
  }
  RC_ASSERT(line.points.size() == stops + 1);
}

TEST(FirstVertices, SaysWhatMeansNothing) {
  const reference::Hierarchy h = reference::random_hierarchy(3);
  const reference::TemporaryStore file(h);
  const Terrain terrain(file.open());
  const std::vector<MapPoint> points = {{0, 0}, {1, 1}};
  LocateRequest request;
  request.detail.vertices = h.t0.vertices.size() - 1;
  EXPECT_THROW(static_cast<void>(locate(terrain, points, request)), Error);
  request.detail.vertices = h.t0.vertices.size();
  EXPECT_NO_THROW(static_cast<void>(locate(terrain, points, request)));
  request.detail.tolerance = 1.0;
  EXPECT_THROW(static_cast<void>(locate(terrain, points, request)), Error);
}

}  // namespace
}  // namespace ptin
