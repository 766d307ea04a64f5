// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions of a mesh that was received, against the same questions of the file from which it came.
#include "engine/query/received/received_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/shape/spot.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::nasty_spot;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;

/// An edge of a surface, from west to east.
struct Edge {
  GridPoint a, b;
  double height_a, height_b;

  [[nodiscard]] double beside(GridPoint p) const {
    return (double(b.x) - a.x) * (double(p.y) - a.y) - (double(b.y) - a.y) * (double(p.x) - a.x);
  }
  [[nodiscard]] double height(double share) const {
    return height_a + share * (height_b - height_a);
  }
};

/// The edges of a surface by their western ends.
std::vector<Edge> edges_of(const Tin& tin, const HeightEncoding& heights) {
  std::vector<Edge> edges;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t) || tin.classes[t] != TriangleClass::kSurface) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      VertexId v = tin.triangles[t].v[i], w = tin.triangles[t].v[(i + 1) % 3];
      if (tin.position(w).x < tin.position(v).x) std::swap(v, w);
      edges.push_back({tin.position(v), tin.position(w), heights.height(tin.vertices[v].height),
                       heights.height(tin.vertices[w].height)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.a.x < f.a.x; });
  return edges;
}

/// The largest distance between two surfaces, of which one lies within `error` of the vertices of
/// the other: there, or where their edges cross. Reference hierarchies measure errors at samples,
/// and guess what lies between.
double distance_between(const std::vector<Edge>& full, const std::vector<Edge>& level,
                        double error) {
  double most = error;
  for (const Edge& e : full) {
    for (const Edge& f : level) {
      if (f.a.x > e.b.x) break;
      if (f.b.x < e.a.x || std::max(f.a.y, f.b.y) < std::min(e.a.y, e.b.y) ||
          std::min(f.a.y, f.b.y) > std::max(e.a.y, e.b.y)) {
        continue;
      }
      const double fa = f.beside(e.a), fb = f.beside(e.b), ea = e.beside(f.a), eb = e.beside(f.b);
      if (fa * fb >= 0 || ea * eb >= 0) continue;  // what touches does so at a vertex
      most = std::max(most, std::abs(e.height(fa / (fa - fb)) - f.height(ea / (ea - eb))));
    }
  }
  return most * (1 + 1e-9);
}

/// A terrain, its mesh at a level of detail, and places on it.
struct Received {
  explicit Received(std::uint64_t seed, std::optional<double> tolerance_of_relief)
      : random(seed),
        hierarchy(reference::random_hierarchy(seed)),
        file(hierarchy),
        terrain(file.open()),
        facts(terrain.store().facts()),
        map(facts.map, facts.bounds) {
    RefineRequest request;
    if (tolerance_of_relief) {
      request.detail.tolerance = *tolerance_of_relief * (facts.max_height - facts.min_height);
    }
    detail = request.detail;
    refined = terrain.refine(request);
    certificate = {refined.certified_error, 0.0, !tolerance_of_relief};
    if (tolerance_of_relief) {
      certificate.deviation =
          distance_between(edges_of(hierarchy.full, facts.heights),
                           edges_of(refined.tin, facts.heights), refined.certified_error);
    }
  }
  [[nodiscard]] ReceivedMesh mesh() const { return {refined.tin, facts, certificate}; }
  [[nodiscard]] MapPoint place() { return map.map(nasty_spot(random, hierarchy.full)); }

  std::mt19937_64 random;
  Hierarchy hierarchy;
  reference::TemporaryStore file;
  Terrain terrain;
  StoreFacts facts;
  SpotMap map;
  DetailRequest detail;
  RefinedTin refined;
  Certificate certificate;
};

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

RC_GTEST_PROP(ReceivedMesh, TellsTheHeightsOfItsLevelAndHoldsThoseOfTheFullTin,
              (std::uint64_t seed)) {
  Received r(seed, 0.1);
  for (int i = 0; i < 8; ++i) {
    const MapPoint at = r.place();
    LocateRequest request;
    request.detail = r.detail;
    const LocatedPoint level = r.terrain.locate({&at, 1}, request).points[0];
    const LocatedPoint full = r.terrain.locate({&at, 1}, {}).points[0];
    const LocatedPoint found = locate_on(r.mesh(), at);
    RC_ASSERT(found.state == level.state);
    RC_ASSERT(same(found.height, level.height));
    if (found.state == PointState::kSurface && full.state == PointState::kSurface) {
      RC_ASSERT(found.height_min <= full.height && full.height <= found.height_max);
    }
  }
}

RC_GTEST_PROP(ReceivedMesh, HasTheProfileOfItsLevelPointByPoint, (std::uint64_t seed)) {
  Received r(seed, 0.1);
  const auto distance = [](MapPoint a, MapPoint b) { return 3 * std::hypot(b.x - a.x, b.y - a.y); };
  for (int i = 0; i < 4; ++i) {
    const MapPoint line[] = {r.place(), r.place()};
    if (r.map.spot(line[0]) == r.map.spot(line[1])) continue;
    ProfileRequest request;
    request.detail = r.detail;
    request.ground_distance = distance;
    const std::vector<ProfilePoint> level = r.terrain.profile(line, request).points;
    const std::vector<ProfilePoint> found =
        profile_on(r.mesh(), line[0], line[1], distance, kMemory);
    RC_ASSERT(found.size() == level.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      RC_ASSERT(found[k].position == level[k].position);
      RC_ASSERT(found[k].distance == level[k].distance);
      RC_ASSERT(same(found[k].height, level[k].height));
      RC_ASSERT(found[k].state == level[k].state);
    }
  }
}

/// Asks the mesh and the file for lines of sight between the same places.
template <class Holds>
void compare_sight(Received& r, const Holds& holds) {
  std::uniform_real_distribution<double> height(
      0, 0.3 * (r.facts.max_height - r.facts.min_height) + 1);
  SightRequest request;
  request.ground_distance = [](MapPoint a, MapPoint b) { return std::hypot(b.x - a.x, b.y - a.y); };
  for (int i = 0; i < 6; ++i) {
    const SightPair pair{r.place(), height(r.random), r.place(), height(r.random)};
    if (r.map.spot(pair.a) == r.map.spot(pair.b)) continue;
    holds(sight_on(r.mesh(), pair, request), r.terrain.sight(pair, request));
  }
}

RC_GTEST_PROP(ReceivedMesh, NeverSaysOfALineOfSightWhatTheFullTinDenies, (std::uint64_t seed)) {
  Received r(seed, 0.05);
  compare_sight(r, [](const SightResult& found, const SightResult& full) {
    RC_ASSERT(found.length == full.length);
    if (found.verdict != SightVerdict::kUndecided) {
      RC_ASSERT(found.verdict == full.verdict);
    }
    if (std::isfinite(found.clearance_min) && std::isfinite(full.clearance_min) &&
        full.verdict != SightVerdict::kUndefined) {
      RC_ASSERT(found.clearance_min <= full.clearance_max);
      RC_ASSERT(found.clearance_max >= full.clearance_min);
    }
  });
}

RC_GTEST_PROP(ReceivedMesh, DecidesLinesOfSightAsTheFileWhenNothingIsMissing,
              (std::uint64_t seed)) {
  Received r(seed, std::nullopt);
  compare_sight(r, [](const SightResult& found, const SightResult& full) {
    RC_ASSERT(found.verdict == full.verdict);
    RC_ASSERT(same(found.clearance_min, full.clearance_min));
    RC_ASSERT(same(found.clearance_max, full.clearance_max));
    RC_ASSERT(found.obstruction.has_value() == full.obstruction.has_value());
  });
}

TEST(ReceivedMesh, LeavesALineOpenWhoseEndMayStandInAVoid) {
  Received r(128836539730, 0.05);
  int undefined = 0;
  compare_sight(r, [&](const SightResult& found, const SightResult& full) {
    if (full.verdict == SightVerdict::kUndefined) {
      ++undefined;
      EXPECT_EQ(found.verdict, SightVerdict::kUndecided);
    }
  });
  EXPECT_EQ(undefined, 1);
}

/// A triangle of the level and one of the full TIN lie in one plane, and round its heights apart.
TEST(ReceivedMesh, HoldsAHeightThatAnotherTriangleRounds) {
  Received r(1718499560924933215, 0.1);
  int other = 0;
  for (int i = 0; i < 8; ++i) {
    const MapPoint at = r.place();
    LocateRequest request;
    request.detail = r.detail;
    const LocatedPoint full = r.terrain.locate({&at, 1}, {}).points[0];
    for (const LocatedPoint& found :
         {locate_on(r.mesh(), at), r.terrain.locate({&at, 1}, request).points[0]}) {
      if (found.state != PointState::kSurface) continue;
      other += found.height != full.height ? 1 : 0;
      EXPECT_LE(found.height_min, full.height);
      EXPECT_GE(found.height_max, full.height);
    }
  }
  EXPECT_EQ(other, 2);
}

TEST(ReceivedMesh, RefusesALineWithoutALengthBySentences) {
  Received r(7, 0.1);
  const MapPoint at = r.place();
  EXPECT_THROW(static_cast<void>(profile_on(r.mesh(), at, at, {}, kMemory)), Error);
  EXPECT_THROW(static_cast<void>(sight_on(r.mesh(), {at, 2, at, 2}, {})), Error);
}

TEST(ReceivedMesh, KnowsOfAnyMeshThatItLiesBetweenTheLeastAndTheGreatestHeight) {
  StoreFacts facts;
  facts.min_height = 100;
  facts.max_height = 350;
  facts.base_error = 1;
  facts.base_deviation = 2;
  const Certificate relief = certificate_by_relief(facts);
  EXPECT_EQ(relief.error, 251);
  EXPECT_EQ(relief.deviation, 252);
  EXPECT_FALSE(relief.complete);
}

}  // namespace
}  // namespace ptin
