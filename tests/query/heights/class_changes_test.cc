// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples that change their class, against every sample looked for in every triangle.
#include "engine/query/heights/class_changes.h"

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/crs/border_move.h"
#include "engine/error.h"
#include "engine/mesh/triangle_holds.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using Counts = std::pair<std::uint64_t, std::uint64_t>;  // to void, to surface

/// Whether closed triangles of surface, or of void, hold the point; and whether surface lies all
/// around it.
Counts brute_force(const Tin& finest, const Tin& level, const GridBox& box) {
  Counts counts{0, 0};
  std::vector<bool> was_surface(finest.vertices.size());
  for (TriangleId t = 0; t < finest.triangles.size(); ++t) {
    if (finest.classes[t] != TriangleClass::kSurface) continue;
    for (const VertexId v : finest.triangles[t].v) was_surface[v] = true;
  }
  for (VertexId v = 0; v < finest.vertices.size(); ++v) {
    const GridPoint p = finest.position(v);
    if (!contains(box, p)) continue;
    bool surface = false, is_void = false;
    for (TriangleId t = 0; t < level.triangles.size(); ++t) {
      if (!triangle_holds(level, level.triangles[t], p)) continue;
      (level.classes[t] == TriangleClass::kSurface ? surface : is_void) = true;
    }
    if (was_surface[v] && !surface) ++counts.first;
    if (!was_surface[v] && !is_void) ++counts.second;
  }
  return counts;
}

Counts counts_of(const ClassChanges& changes) { return {changes.to_void, changes.to_surface}; }

GridBox everywhere() { return {0, 0, kGridMax, kGridMax}; }

RC_GTEST_PROP(ClassChanges, AreThoseThatEverySampleTells, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const reference::Hierarchy hierarchy = reference::simplify(
      reference::random_grid(random, *rc::gen::inRange(4, 20), *rc::gen::inRange(4, 20), 3, 0.2),
      random);
  const reference::TemporaryStore file(hierarchy);
  const Terrain terrain(file.open());
  const double tolerance = *rc::gen::inRange(0, 30);
  RefineRequest level;
  level.detail.tolerance = tolerance;
  const Tin coarse = terrain.refine(level).tin;
  ClassChangesRequest request;
  request.detail = level.detail;
  const Counts all = counts_of(terrain.class_changes(request));
  RC_ASSERT(all == brute_force(hierarchy.full, coarse, everywhere()));
  RC_CLASSIFY(all.first > 0, "became void");
  RC_CLASSIFY(all.second > 0, "became surface");
  // A window counts what lies in it.
  const std::int32_t x = *rc::gen::inRange(0, 40), y = *rc::gen::inRange(0, 40);
  const AffineMap& map = terrain.store().facts().map;
  const MapPoint low = map.to_map(x, y), high = map.to_map(x + 20, y + 15);
  request.region = Window{low.x, low.y, high.x, high.y};
  RC_ASSERT(counts_of(terrain.class_changes(request)) ==
            brute_force(hierarchy.full, coarse, {x, y, x + 20, y + 15}));
}

TEST(ClassChanges, AreTheSameNearTheBorderAndEverywhere) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  bool any = false;
  for (const double tolerance : {2.0, 10.0, 40.0}) {
    RefineRequest level;
    level.detail.tolerance = tolerance;
    const RefinedTin coarse = terrain.refine(level);
    ClassChangesRequest request;
    request.detail = level.detail;
    request.reach = border_reach(terrain.store(), coarse.certified_error);
    ASSERT_TRUE(std::isfinite(request.reach[0]));
    const ClassChanges near = terrain.class_changes(request);
    any = any || near.to_void + near.to_surface > 0;
    request.limits.memory_bytes = std::uint64_t{8} << 20;
    EXPECT_EQ(counts_of(terrain.class_changes(request)), counts_of(near)) << "in parts";
    request.reach = {kInfinity, kInfinity};
    EXPECT_EQ(counts_of(terrain.class_changes(request)), counts_of(near)) << "everywhere";
  }
  EXPECT_TRUE(any) << "the terrain shows nothing";
}

TEST(ClassChanges, OfTheFullTinAreNone) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const ClassChanges changes = terrain.class_changes({});
  EXPECT_EQ(counts_of(changes), Counts(0, 0));
  EXPECT_EQ(changes.cost.records_retrieved, 0U);
}

TEST(ClassChanges, RefuseANegativeReach) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  ClassChangesRequest request;
  request.reach = {-1.0, 0.0};
  EXPECT_THROW(static_cast<void>(terrain.class_changes(request)), Error);
}

}  // namespace
}  // namespace ptin
