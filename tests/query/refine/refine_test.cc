// SPDX-License-Identifier: GPL-3.0-or-later
//
// The promises of refinement (engine/DESIGN.md, section 2.8) over random terrains and predicates, against
// brute force.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/coarsest.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::canonical;
using reference::Corners;
using reference::Hierarchy;
using reference::TemporaryStore;

/// A terrain, its store and the object that is asked.
struct RefineCase {
  explicit RefineCase(std::uint64_t seed)
      : random(seed),
        hierarchy(reference::random_hierarchy(seed)),
        file(hierarchy),
        tin(file.open()) {}
  [[nodiscard]] std::size_t count(const AttributePredicate& p) const {
    return static_cast<std::size_t>(std::count_if(
        hierarchy.records.begin(), hierarchy.records.end(),
        [&](const VertexSplit& r) { return p.holds(attributes_of(r, hierarchy.facts.heights)); }));
  }
  [[nodiscard]] RefinedTin refine(const AttributePredicate& p) const {
    RefineRequest request;
    request.also = &p;
    return tin.refine(request);
  }
  std::mt19937_64 random;
  Hierarchy hierarchy;
  TemporaryStore file;
  Terrain tin;
};

std::vector<Corners> meeting(const Tin& tin, const GridRegion& region) {
  std::vector<Corners> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    if (region.meets(tin.position(triangle.v[0]), tin.position(triangle.v[1]),
                     tin.position(triangle.v[2]))) {
      all.push_back(reference::corners_of(tin, t));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// What is wrong with the neighbours or vertices of a mesh that need not be a disk: each side is
/// joined with the one triangle that has the same edge the other way round, if there is one, and
/// each vertex names one of its triangles.
std::string connectivity_fault(const Tin& tin) {
  std::map<std::pair<VertexId, VertexId>, TriangleId> of_edge;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      of_edge[{tin.triangles[t].v[next_corner(i)], tin.triangles[t].v[previous_corner(i)]}] = t;
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto& [v, n] = tin.triangles[t];
      const auto other = of_edge.find({v[previous_corner(i)], v[next_corner(i)]});
      if (n[i] != (other == of_edge.end() ? kNone : other->second)) {
        return "neighbour of triangle " + std::to_string(t);
      }
    }
  }
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const TriangleId t = tin.vertices[v].triangle;
    if (t >= tin.triangles.size() ||
        std::find(tin.triangles[t].v, tin.triangles[t].v + 3, v) == tin.triangles[t].v + 3) {
      return "triangle of vertex " + std::to_string(v);
    }
  }
  return {};
}

TEST(Refine, WithoutAnyWishGivesTheFullTinBackExactly) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const RefineCase asked(seed);
    const RefinedTin result = asked.tin.refine({});
    EXPECT_EQ(validate(result.tin), "") << "seed " << seed;
    EXPECT_EQ(canonical(result.tin), canonical(asked.hierarchy.full)) << "seed " << seed;
    EXPECT_TRUE(result.exact);
    EXPECT_EQ(result.certified_error, 0.0);
    EXPECT_EQ(result.cost.records_applied, asked.hierarchy.records.size());
    EXPECT_EQ(result.vertices, asked.hierarchy.full.vertices.size());
  }
}

RC_GTEST_PROP(Refine, IsValidAndAppliesExactlyTheRecordsOfThePredicate, (std::uint64_t seed)) {
  RefineCase asked(seed);
  for (int i = 0; i < 4; ++i) {
    const PredicatePtr p = reference::random_predicate(asked.random, asked.hierarchy.facts, 3);
    const RefinedTin result = asked.refine(*p);
    RC_ASSERT(validate(result.tin).empty());                                // P3
    RC_ASSERT(twice_area(result.tin) == twice_area(asked.hierarchy.full));  // the same domain
    RC_ASSERT(result.cost.records_applied == asked.count(*p));              // P4
    RC_ASSERT(result.cost.records_retrieved == result.cost.records_applied);
    RC_ASSERT(result.vertices == result.t0_vertices + result.cost.records_applied);
    RC_ASSERT(result.triangles == result.tin.alive_triangles());
  }
}

RC_GTEST_PROP(Refine, GivesEveryTriangleOfTheFullTinThatMeetsTheRegion, (std::uint64_t seed)) {
  RefineCase asked(seed);
  for (int i = 0; i < 4; ++i) {
    RefineRequest request;
    request.region = reference::random_region(asked.random, asked.hierarchy.facts);
    const GridRegion region(*request.region, asked.hierarchy.facts.map);
    const std::vector<Corners> wanted = meeting(asked.hierarchy.full, region);
    const RefinedTin whole = asked.tin.refine(request);
    RC_ASSERT(meeting(whole.tin, region) == wanted);  // P1
    RC_ASSERT(whole.exact);
    RC_ASSERT(whole.certified_error == 0.0);
    request.form = ResultForm::kMeetingRegion;
    const RefinedTin part = asked.tin.refine(request);
    RC_ASSERT(canonical(part.tin) == wanted);
    RC_ASSERT(part.triangles == wanted.size());
    RC_ASSERT(connectivity_fault(part.tin).empty());
  }
}

RC_GTEST_PROP(Refine, TwoRegionsAgreeOnTrianglesThatMeetBoth, (std::uint64_t seed)) {
  RefineCase asked(seed);
  const PredicatePtr level = reference::random_predicate(asked.random, asked.hierarchy.facts, 1);
  for (int i = 0; i < 4; ++i) {
    RefineRequest request[2];
    std::vector<Corners> both[2];
    std::optional<double> tolerance;
    if (asked.random() % 2 == 0) {
      tolerance = static_cast<double>(asked.random() % 40) * 0.5;
    }
    for (RefineRequest& r : request) {
      r.region = reference::random_region(asked.random, asked.hierarchy.facts);
      r.detail.tolerance = tolerance;
      r.also = tolerance ? nullptr : level.get();
    }
    for (int side = 0; side < 2; ++side) {
      const RefinedTin mine = asked.tin.refine(request[side]);
      const auto a = meeting(mine.tin, GridRegion(*request[0].region, asked.hierarchy.facts.map));
      const auto b = meeting(mine.tin, GridRegion(*request[1].region, asked.hierarchy.facts.map));
      std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both[side]));
    }
    RC_ASSERT(both[0] == both[1]);  // P5
  }
}

RC_GTEST_PROP(Refine, AnyOrderOfFallingRankGivesTheSameTin, (std::uint64_t seed)) {
  RefineCase asked(seed);
  const PredicatePtr p = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
  const StoreFile& store = asked.tin.store();
  QueryContext context({.memory_bytes = UINT64_MAX}, store.path());
  std::vector<PendingSplit> splits = retrieve({store, store.index()}, *p, 0, context);
  const Tin t0 = mesh_of(store.t0(), store.path());
  std::shuffle(splits.begin(), splits.end(), asked.random);
  Refinement refinement(t0);
  refinement.apply(splits, context);
  RC_ASSERT(canonical(refinement.tin()) == canonical(asked.refine(*p).tin));
}

RC_GTEST_PROP(Refine, TwoClosedSetsOneAfterTheOtherGiveTheUnion, (std::uint64_t seed)) {
  RefineCase asked(seed);
  const StoreFile& store = asked.tin.store();
  const PredicatePtr first = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
  const PredicatePtr both =
      any_of({first, reference::random_predicate(asked.random, asked.hierarchy.facts, 2)});
  QueryContext context({.memory_bytes = UINT64_MAX}, store.path());
  const RecordSource source{store, store.index()};
  Refinement refinement(mesh_of(store.t0(), store.path()));
  refinement.apply(retrieve(source, *first, 0, context), context);
  std::vector<PendingSplit> more = retrieve(source, *both, 0, context);
  std::erase_if(more, [&](const PendingSplit& s) { return refinement.find(s.u) != kNone; });
  refinement.apply(more, context);
  RC_ASSERT(validate(refinement.tin()).empty());
  RC_ASSERT(canonical(refinement.tin()) == canonical(asked.refine(*both).tin));
}

/// Beside the vertices: 1 for those in a surface triangle.
std::vector<std::uint8_t> touches_surface(const Tin& full) {
  std::vector<std::uint8_t> touched(full.vertices.size(), 0);
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    for (const VertexId v : full.triangles[t].v) {
      if (full.classes[t] == TriangleClass::kSurface) {
        touched[v] = 1;
      }
    }
  }
  return touched;
}

/// Largest distance of a sample that some surface triangle holds; a sample with a height that none
/// holds is infinitely off.
double measured_error(const Tin& full, const Tin& tin, const HeightEncoding& heights) {
  const std::vector<std::uint8_t> touched = touches_surface(full);
  double worst = 0.0;
  for (VertexId s = 0; s < full.vertices.size(); ++s) {
    if (full.has_height[s] != 0 && touched[s] == 0) {
      continue;  // a lone sample has no class to keep
    }
    double least = full.has_height[s] != 0 ? INFINITY : 0.0;
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      const Triangle& triangle = tin.triangles[t];
      double weighted = 0.0;
      double area = 0.0;
      std::int64_t smallest = INT64_MAX;
      for (int i = 0; i < 3; ++i) {
        const std::int64_t part =
            orient(tin.position(triangle.v[next_corner(i)]),
                   tin.position(triangle.v[previous_corner(i)]), full.position(s));
        smallest = std::min(smallest, part);
        area += static_cast<double>(part);
        weighted += static_cast<double>(part) * heights.height(tin.vertices[triangle.v[i]].height);
      }
      if (smallest < 0 || tin.classes[t] == TriangleClass::kVoid) {
        continue;
      }
      if (full.has_height[s] != 0) {
        least =
            std::min(least, std::abs(weighted / area - heights.height(full.vertices[s].height)));
      } else if (smallest > 0) {
        least = INFINITY;
      }
    }
    worst = std::max(worst, least);
  }
  return worst;
}

RC_GTEST_PROP(Refine, CertifiedErrorHoldsAtEverySample, (std::uint64_t seed)) {
  RefineCase asked(seed);
  for (const double tolerance : {0.0, 0.5, 3.0, 12.0}) {
    RefineRequest request;
    request.detail.tolerance = tolerance;
    const RefinedTin result = asked.tin.refine(request);
    RC_ASSERT(result.certified_error <= tolerance);
    RC_ASSERT(measured_error(asked.hierarchy.full, result.tin, asked.hierarchy.facts.heights) <=
              result.certified_error * (1 + 1e-12) + 1e-12);  // P2
    RC_ASSERT(result.certified_deviation >= result.certified_error);
  }
}

TEST(Refine, CertificateIsThatOfTheRecordsLeftOutToAnEighthOfAnOctave) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const RefineCase asked(seed);
    for (const double tolerance : {0.0, 1.0, 7.5, 1e9}) {
      RefineRequest request;
      request.detail.tolerance = tolerance;
      const RefinedTin result = asked.tin.refine(request);
      double largest = -1.0;
      double deviation = 0.0;
      for (const VertexSplit& r : asked.hierarchy.records) {
        if (!(r.error > tolerance)) {
          largest = std::max<double>(largest, r.error);
          deviation = std::max<double>(deviation, r.deviation);
        }
      }
      EXPECT_GE(result.certified_error, largest);
      EXPECT_LE(result.certified_error, std::max(0.0, largest) * 1.125);
      EXPECT_GE(result.certified_deviation, deviation);
      EXPECT_EQ(result.exact, largest < 0);
    }
  }
}

TEST(Refine, RegionOutsideOfTheTerrainGivesT0) {
  const RefineCase asked(3);
  RefineRequest request;
  request.region = Window{-1e6, -1e6, -9e5, -9e5};
  const RefinedTin whole = asked.tin.refine(request);
  EXPECT_EQ(whole.cost.records_applied, 0u);
  EXPECT_EQ(whole.cost.io.pages, 0u);
  EXPECT_EQ(whole.vertices, whole.t0_vertices);
  request.form = ResultForm::kMeetingRegion;
  const RefinedTin part = asked.tin.refine(request);
  EXPECT_EQ(part.triangles, 0u);
  EXPECT_EQ(part.vertices, 0u);
  EXPECT_EQ(part.t0_vertices, whole.t0_vertices);
}

TEST(Refine, SaysWhichPageMadeEachTriangle) {
  const RefineCase asked(5);
  RefineRequest request;
  request.page_of_triangle = true;
  const RefinedTin result = asked.tin.refine(request);
  ASSERT_EQ(result.page_of_triangle.size(), result.triangles);
  const std::vector<Corners> t0 = canonical(mesh_of(asked.hierarchy.t0, "t0"));
  for (TriangleId t = 0; t < result.triangles; ++t) {
    const bool coarse =
        std::binary_search(t0.begin(), t0.end(), reference::corners_of(result.tin, t));
    EXPECT_EQ(result.page_of_triangle[t] == kNone, coarse);
    if (!coarse) {
      EXPECT_LT(result.page_of_triangle[t], asked.tin.store().pages().page_count());
    }
  }
  EXPECT_TRUE(asked.tin.refine({}).page_of_triangle.empty());
}

TEST(Refine, PagesFollowTheirTrianglesIntoAClippedMesh) {
  const RefineCase asked(8);
  RefineRequest request;
  const StoreFacts& f = asked.hierarchy.facts;
  const MapPoint low = f.map.to_map(f.bounds.min_x, f.bounds.min_y);
  const MapPoint mid = f.map.to_map(f.bounds.max_x * 0.4, f.bounds.max_y * 0.6);
  request.region = Window{low.x, low.y, mid.x, mid.y};
  request.page_of_triangle = true;
  const RefinedTin whole = asked.tin.refine(request);
  request.form = ResultForm::kMeetingRegion;
  const RefinedTin part = asked.tin.refine(request);
  std::map<Corners, std::uint32_t> pages;
  for (TriangleId t = 0; t < whole.triangles; ++t) {
    pages[reference::corners_of(whole.tin, t)] = whole.page_of_triangle[t];
  }
  ASSERT_EQ(part.page_of_triangle.size(), part.triangles);
  for (TriangleId t = 0; t < part.triangles; ++t) {
    EXPECT_EQ(part.page_of_triangle[t], pages.at(reference::corners_of(part.tin, t)));
  }
}

ErrorCode code_of(const Terrain& tin, const RefineRequest& request) {
  try {
    (void)tin.refine(request);
  } catch (const Error& e) {
    return e.code();
  }
  ADD_FAILURE() << "no error";
  return ErrorCode::internal;
}

TEST(RefineRequest, RejectsValuesOutsideOfItsContract) {
  const RefineCase asked(1);
  std::vector<RefineRequest> bad(8);
  bad[0].detail.tolerance = -1.0;
  bad[1].detail.tolerance = std::nan("");
  bad[2].detail.tolerance = 1.0;
  bad[2].detail.vertices = 1000;
  bad[3].detail.vertices = asked.hierarchy.t0.vertices.size() - 1;
  bad[4].region = Window{1, 0, 0, 1};
  bad[5].region = MapPoint{std::nan(""), 0};
  bad[6].region = Segment{{0, 0}, {INFINITY, 0}};
  bad[7].region = Polygon{{{{0, 0}, {1, 1}}}};
  for (const RefineRequest& request : bad) {
    EXPECT_EQ(code_of(asked.tin, request), ErrorCode::invalid_argument);
  }
}

TEST(RefineRequest, RefusesBeforeReadingWhenTheAnswerMayExceedTheMemoryLimit) {
  const RefineCase asked(2);
  RefineRequest request;
  request.limits.memory_bytes = 1000;
  try {
    (void)asked.tin.refine(request);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("export"), std::string::npos);
  }
  request.detail.vertices = asked.hierarchy.full.vertices.size();
  EXPECT_EQ(code_of(asked.tin, request), ErrorCode::resource_exhausted);
}

TEST(RefineRequest, StopTokenEndsTheQuery) {
  const RefineCase asked(2);
  std::stop_source stop;
  stop.request_stop();
  RefineRequest request;
  request.limits.stop = stop.get_token();
  EXPECT_EQ(code_of(asked.tin, request), ErrorCode::cancelled);
}

TEST(Refine, PreadAndMappedGiveTheSameBytes) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const RefineCase asked(seed);
    const Terrain other(asked.file.open(PageAccess::kPread));
    RefineRequest request;
    request.detail.tolerance = 2.0;
    const RefinedTin a = asked.tin.refine(request);
    const RefinedTin b = other.refine(request);
    ASSERT_EQ(a.triangles, b.triangles);
    for (TriangleId t = 0; t < a.triangles; ++t) {
      EXPECT_TRUE(std::equal(a.tin.triangles[t].v, a.tin.triangles[t].v + 3, b.tin.triangles[t].v));
    }
  }
}

}  // namespace
}  // namespace ptin
