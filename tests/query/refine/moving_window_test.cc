// SPDX-License-Identifier: GPL-3.0-or-later
//
// The moving window against fresh refinements, over random terrains and random sequences of moves.
#include "engine/query/refine/moving_window.h"

#include <algorithm>
#include <memory>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::canonical;
using reference::Hierarchy;
using reference::TemporaryStore;

struct MovingWindowCase {
  explicit MovingWindowCase(std::uint64_t seed)
      : random(seed),
        hierarchy(reference::random_hierarchy(seed)),
        file(hierarchy),
        store(file.open()),
        tin(store) {}
  [[nodiscard]] RefinedTin fresh(const AttributePredicate& p) const {
    RefineRequest request;
    request.also = &p;
    return tin.refine(request);
  }
  /// Records for which `p` is true and `q` is not.
  [[nodiscard]] std::size_t alone(const AttributePredicate* p, const AttributePredicate* q) const {
    return static_cast<std::size_t>(
        std::count_if(hierarchy.records.begin(), hierarchy.records.end(), [&](const auto& r) {
          const Attributes a = attributes_of(r, hierarchy.facts.heights);
          return p != nullptr && p->holds(a) && !(q != nullptr && q->holds(a));
        }));
  }
  /// A window of a share of the terrain's sides, its lower left corner at (x, y) of what is left.
  [[nodiscard]] PredicatePtr window_at(double x, double y, double share) const {
    const StoreFacts& f = hierarchy.facts;
    const double width = f.bounds.max_x - f.bounds.min_x;
    const double height = f.bounds.max_y - f.bounds.min_y;
    const double low_x = f.bounds.min_x + x * (1 - share) * width;
    const double low_y = f.bounds.min_y + y * (1 - share) * height;
    const MapPoint low = f.map.to_map(low_x, low_y);
    const MapPoint high = f.map.to_map(low_x + share * width, low_y + share * height);
    return meets_region(Window{low.x, low.y, high.x, high.y}, f.map);
  }
  std::mt19937_64 random;
  Hierarchy hierarchy;
  TemporaryStore file;
  std::shared_ptr<const StoreFile> store;
  Terrain tin;
};

void require_fresh(const MovingWindow& window, const MoveResult& moved, const RefinedTin& fresh) {
  RC_ASSERT(canonical(window.tin()) == canonical(fresh.tin));
  const Tin compact = window.compact_tin();
  RC_ASSERT(validate(compact).empty());
  RC_ASSERT(canonical(compact) == canonical(fresh.tin));
  RC_ASSERT(moved.vertices == fresh.vertices);
  RC_ASSERT(moved.triangles == fresh.triangles);
  RC_ASSERT(compact.vertices.size() == fresh.vertices);
  RC_ASSERT(window.tin().alive_vertices() == fresh.vertices);
  RC_ASSERT(moved.certificate.error == fresh.certified_error);
  RC_ASSERT(moved.certificate.deviation == fresh.certified_deviation);
}

RC_GTEST_PROP(MovingWindow, IsAfterEachMoveAFreshRefinement, (std::uint64_t seed)) {
  MovingWindowCase asked(seed);
  MovingWindowOptions options;
  options.page_cache_bytes = asked.random() % 3 == 0 ? 10'000 : options.page_cache_bytes;
  MovingWindow window{OpenedTerrain(asked.store), options};
  PredicatePtr before;
  for (int i = 0; i < 8; ++i) {
    const PredicatePtr p = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
    const MoveResult moved = window.move_to(p);
    require_fresh(window, moved, asked.fresh(*p));
    RC_ASSERT(moved.entered == asked.alone(p.get(), before.get()));
    RC_ASSERT(moved.left == asked.alone(before.get(), p.get()));
    RC_ASSERT(moved.cost.records_applied == moved.entered);
    RC_ASSERT(window.page_cache_bytes() <= std::max<std::uint64_t>(options.page_cache_bytes, 9000));
    before = p;
  }
}

RC_GTEST_PROP(MovingWindow, FollowsAWindowThatDriftsAndChangesItsTolerance, (std::uint64_t seed)) {
  MovingWindowCase asked(seed);
  MovingWindow window{OpenedTerrain(asked.store)};
  double x = 0.3, y = 0.6, tolerance = 2;
  std::uniform_real_distribution<double> step(-0.08, 0.08);
  for (int i = 0; i < 12; ++i) {
    x = std::clamp(x + step(asked.random), 0.0, 1.0);
    y = std::clamp(y + step(asked.random), 0.0, 1.0);
    tolerance = asked.random() % 4 == 0 ? tolerance * 1.3 : tolerance;
    const PredicatePtr p = asked.random() % 5 == 0
                               ? asked.window_at(x, y, 0.3)
                               : all_of({asked.window_at(x, y, 0.3), error_above(tolerance)});
    require_fresh(window, window.move_to(p), asked.fresh(*p));
  }
}

// The example of view-dependent use: an eye flies over the terrain and looks back; the mesh is fine
// near it and coarse far away, and each frame costs what changed.
TEST(MovingWindow, FollowsAnEyeThatFliesOverTheTerrain) {
  const MovingWindowCase asked(11);
  const StoreFacts& f = asked.hierarchy.facts;
  MovingWindow window{OpenedTerrain(asked.store)};
  std::uint64_t largest = 0;
  for (int frame = 0; frame <= 40; ++frame) {
    const double along = f.bounds.min_x + (f.bounds.max_x - f.bounds.min_x) * frame / 40.0;
    View view;
    view.eye = f.map.to_map(along, 0.5 * (f.bounds.min_y + f.bounds.max_y));
    view.eye_height = frame % 2 == 0 ? std::optional(f.max_height + 10) : std::nullopt;
    view.tau = 0.02;
    const PredicatePtr p = seen_from(view, f.map, f.heights);
    const MoveResult moved = window.move_to(p);
    EXPECT_EQ(canonical(window.tin()), canonical(asked.fresh(*p).tin)) << "frame " << frame;
    EXPECT_EQ(moved.vertices, window.tin().alive_vertices());
    largest = std::max(largest, moved.entered);
  }
  EXPECT_GT(largest, 0u);
}

TEST(MovingWindow, ReadsNoPageTwiceWhileTheyFitTheCache) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const MovingWindowCase asked(seed);
    MovingWindow window{OpenedTerrain(asked.store)};
    std::uint64_t pages = 0;
    for (const double x : {0.1, 0.2, 0.3, 0.2, 0.1, 0.15, 0.3}) {
      pages += window.move_to(asked.window_at(x, x, 0.4)).cost.io.pages;
    }
    EXPECT_LE(pages, asked.store->pages().page_count());
    const MoveResult back = window.move_to(asked.window_at(0.1, 0.1, 0.4));
    EXPECT_EQ(back.cost.io.pages, 0u);
    const MoveResult again = window.move_to(asked.window_at(0.1, 0.1, 0.4));
    EXPECT_EQ(again.entered + again.left, 0u);
  }
}

TEST(MovingWindow, LeavesPagesInsideOfBothWindowsAlone) {
  std::mt19937_64 random(1);
  const Hierarchy h =
      reference::simplify(reference::random_grid(random, 180, 180, 4, 0.0), random, {0.02, false});
  const TemporaryStore file(h);
  MovingWindow window{OpenedTerrain(file.open())};
  const auto at = [&](double x) {
    const MapPoint low = h.facts.map.to_map(x, 20);
    const MapPoint high = h.facts.map.to_map(x + 600, 620);
    return meets_region(Window{low.x, low.y, high.x, high.y}, h.facts.map);
  };
  const MoveResult first = window.move_to(at(40));
  const MoveResult moved = window.move_to(at(44));
  EXPECT_GT(moved.entered, 0u);
  EXPECT_GT(moved.left, 0u);
  EXPECT_LT(moved.pages_examined, first.pages_examined);
  EXPECT_LT(moved.entered + moved.left, first.entered / 5);
}

TEST(MovingWindow, RefusesMoreThanItsMemoryBeforeReadingAndStaysAsItWas) {
  const MovingWindowCase asked(2);
  MovingWindowOptions options;
  options.page_cache_bytes = 4096;
  options.memory_bytes = 4096 + refinement_bytes(asked.hierarchy.records.size() / 2);
  MovingWindow window{OpenedTerrain(asked.store), options};
  window.move_to(error_above(1e9));
  const auto before = canonical(window.tin());
  try {
    window.move_to(everything());
    FAIL() << "more than the limit was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
  }
  EXPECT_EQ(canonical(window.tin()), before);
  window.move_to(error_above(1e8));
  options.memory_bytes = options.page_cache_bytes - 1;
  EXPECT_THROW(MovingWindow(OpenedTerrain(asked.store), options), Error);
  EXPECT_THROW(window.move_to(nullptr), Error);
}

TEST(MovingWindow, StaysAsItWasWhenCancelled) {
  const MovingWindowCase asked(6);
  MovingWindow window{OpenedTerrain(asked.store)};
  window.move_to(asked.window_at(0.5, 0.5, 0.5));
  const auto before = canonical(window.tin());
  std::stop_source stop;
  stop.request_stop();
  try {
    window.move_to(everything(), stop.get_token());
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(canonical(window.tin()), before);
  window.move_to(everything());
  EXPECT_EQ(canonical(window.tin()), canonical(asked.hierarchy.full));
}

/// Refusals in six moves over records whose errors are not saturated: a predicate then tells off a
/// record that others need.
int refusals_over_unsaturated(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Hierarchy h = reference::random_hierarchy(seed);
  for (VertexSplit& r : h.records) {
    if (random() % 4 == 0) {
      r.error *= 0.3F;
    }
  }
  const TemporaryStore file(h);
  MovingWindow window{OpenedTerrain(file.open())};
  int refusals = 0;
  for (int i = 0; i < 6; ++i) {
    const PredicatePtr p = i % 2 == 0 ? everything() : error_above(static_cast<double>(i));
    try {
      window.move_to(p);
    } catch (const Error& e) {
      ++refusals;
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      EXPECT_NE(std::string(e.what()).find("page"), std::string::npos) << e.what();
      EXPECT_EQ(window.tin().vertices.size(), h.t0.vertices.size());
    }
    EXPECT_TRUE(validate(window.compact_tin()).empty());
  }
  return refusals;
}

TEST(MovingWindow, NamesRecordsThatAreNotSaturatedAndBeginsAgain) {
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    refused += refusals_over_unsaturated(seed) > 0 ? 1 : 0;
  }
  EXPECT_GT(refused, 20) << "of 40 damaged terrains";
}

}  // namespace
}  // namespace ptin
