// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a selective refinement says that it holds, and that questions count all of it.
#include "engine/query/paper/selective_refinement.h"

#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/select/predicate.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/least_memory.h"

namespace ptin::paper {
namespace {

using reference::Hierarchy;
using reference::TemporaryStore;

/// What the arrays of a mesh take at least.
std::uint64_t array_bytes(const Tin& tin) {
  return tin.vertices.size() * (sizeof(Vertex) + sizeof(tin.has_height[0])) +
         tin.triangles.size() * (sizeof(Triangle) + sizeof(tin.classes[0]));
}

struct HeldTerrain {
  std::mt19937_64 random{8};
  Hierarchy hierarchy =
      reference::simplify_unmeasured(reference::random_grid(random, 40, 40, 4, 0.0), random);
  TemporaryStore file{hierarchy};
  Terrain terrain{file.open()};
};

TEST(SelectiveRefinement, CountsItsArraysAndTheRecordsAddedLast) {
  const HeldTerrain t;
  QueryContext context({.memory_bytes = std::uint64_t{1} << 30}, "a test");
  SelectiveRefinement mesh(t.terrain, Detail(t.terrain.store()));
  const std::uint64_t of_t0 = mesh.bytes();
  EXPECT_GE(of_t0, array_bytes(mesh.tin()));

  const std::size_t first = mesh.refine(AboveError(4.0), context);
  ASSERT_GT(first, 100U);
  const std::uint64_t of_first = mesh.bytes();
  EXPECT_GE(of_first, of_t0 + first * sizeof(PendingSplit));
  EXPECT_GE(of_first, array_bytes(mesh.tin()) + first * sizeof(PendingSplit));

  const std::size_t more = mesh.refine(*everything(), context);
  ASSERT_EQ(first + more, t.hierarchy.records.size());
  const std::uint64_t of_all = mesh.bytes();
  EXPECT_GT(of_all, of_first);
  EXPECT_GE(of_all, array_bytes(mesh.tin()) + more * sizeof(PendingSplit));

  mesh.release_records();
  const std::uint64_t released = mesh.bytes();
  EXPECT_LE(released + more * sizeof(PendingSplit), of_all);
  EXPECT_GE(released, array_bytes(mesh.tin()));
  EXPECT_GT(released, of_t0);
}

TEST(SelectiveRefinement, IsTheSameMeshWithoutItsRecords) {
  const HeldTerrain t;
  QueryContext context({.memory_bytes = std::uint64_t{1} << 30}, "a test");
  SelectiveRefinement released(t.terrain, Detail(t.terrain.store()));
  SelectiveRefinement kept(t.terrain, Detail(t.terrain.store()));
  for (const double tolerance : {9.0, 3.0, 1.0, -1.0}) {
    EXPECT_EQ(released.refine(AboveError(tolerance), context),
              kept.refine(AboveError(tolerance), context));
    released.release_records();
    ASSERT_EQ(reference::canonical(released.tin()), reference::canonical(kept.tin()));
    for (TriangleId id = 0; id < kept.tin().triangles.size(); ++id) {
      ASSERT_EQ(released.bounds(id).deviation, kept.bounds(id).deviation);
      ASSERT_EQ(released.bounds(id).heights.lo, kept.bounds(id).heights.lo);
      ASSERT_EQ(released.bounds(id).heights.hi, kept.bounds(id).heights.hi);
    }
  }
}

TEST(SelectiveRefinement, IsRefusedBelowWhatItsRecordsAndArraysTake) {
  const HeldTerrain t;
  std::uint64_t held = 0;
  const std::uint64_t least = reference::least_memory([&](std::uint64_t limit) {
    QueryContext context({.memory_bytes = limit}, "a test");
    SelectiveRefinement mesh(t.terrain, Detail(t.terrain.store()));
    mesh.refine(AboveError(4.0), context);
    const std::size_t more = mesh.refine(*everything(), context);
    held = array_bytes(mesh.tin()) + more * sizeof(PendingSplit);
  });
  EXPECT_GE(least, held);
  EXPECT_LE(least, 4 * held);
}

}  // namespace
}  // namespace ptin::paper
