// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refinement through either index gives the same answers at the cost of the same pages.
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "engine/query/questions.h"
#include "storage/spatialindex_rtree.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

TEST(Refine, GivesTheSameAnswersOnThePackedAndOnTheSpatialindexTree) {
  for (std::uint64_t seed = 40; seed < 48; ++seed) {
    const reference::Hierarchy h = reference::random_hierarchy(seed);
    const reference::TemporaryStore file(h);
    const std::shared_ptr<const StoreFile> store = file.open();
    const Terrain packed(store);
    Terrain other(store);
    const SpatialIndexOptions options{file.path + ".sidx"};
    other.use_index(SpatialIndexRTree::open(store, options));
    std::mt19937_64 random(seed);
    for (int i = 0; i < 20; ++i) {
      RefineRequest request;
      const PredicatePtr p = reference::random_predicate(random, h.facts, 2);
      request.also = p.get();
      if (i % 4 == 0) {
        request.detail.vertices = h.t0.vertices.size() + random() % (h.records.size() + 1);
      }
      const RefinedTin a = packed.refine(request);
      const RefinedTin b = other.refine(request);
      EXPECT_EQ(reference::canonical(a.tin), reference::canonical(b.tin));
      EXPECT_EQ(a.cost.io.pages, b.cost.io.pages);
      EXPECT_EQ(a.cost.records_retrieved, b.cost.records_retrieved);
    }
    for (const char* end : {".dat", ".idx"}) {
      std::filesystem::remove(options.base + end);
    }
  }
}

}  // namespace
}  // namespace ptin
