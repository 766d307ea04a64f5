// SPDX-License-Identifier: GPL-3.0-or-later
//
// Moves in which the n-th allocation fails, or it and all behind it: the mesh is one that the
// promises name, and the next move makes what it would have made anyway.
#include <atomic>
#include <cstdint>
#include <memory>
#include <new>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "engine/query/refine/moving_window.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/replaced_new.h"

namespace {

/// Allocations until the first that fails, and how many fail from there on.
std::atomic<std::int64_t> moves_allocations_left{0};
std::atomic<std::int64_t> moves_allocations_that_fail{0};

bool fails_in_a_move() {
  if (moves_allocations_that_fail.load(std::memory_order_relaxed) == 0) {
    return false;
  }
  if (moves_allocations_left.fetch_sub(1, std::memory_order_relaxed) > 1) {
    return false;
  }
  moves_allocations_that_fail.fetch_sub(1, std::memory_order_relaxed);
  return true;
}

}  // namespace

namespace ptin {
namespace {

using reference::canonical;
using reference::Hierarchy;
using reference::TemporaryStore;

/// How many fail, for as long as it lives, from the n-th on.
class FailingMoves {
 public:
  FailingMoves(std::int64_t nth, std::int64_t how_many) {
    moves_allocations_left = nth;
    moves_allocations_that_fail = how_many;
  }

 private:
  test::AskedAllocations asked_{fails_in_a_move};
};

constexpr std::int64_t kThisOne = 1;
constexpr std::int64_t kAllBehind = std::int64_t{1} << 40;

class MovingWindowFaults : public ::testing::Test {
 protected:
  [[nodiscard]] PredicatePtr at(double low, double high) const {
    const MapPoint a = hierarchy_.facts.map.to_map(low, low);
    const MapPoint b = hierarchy_.facts.map.to_map(high, high);
    return meets_region(Window{a.x, a.y, b.x, b.y}, hierarchy_.facts.map);
  }
  [[nodiscard]] RefinedTin fresh(const AttributePredicate& p) const {
    RefineRequest request;
    request.also = &p;
    return terrain_.refine(request);
  }

  /// Moves, while the n-th allocation fails. @returns whether the move came to its end
  bool moves(MovingWindow& window, const PredicatePtr& to, std::int64_t nth,
             std::int64_t how_many) const {
    const FailingMoves failing(nth, how_many);
    try {
      window.move_to(to);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

  /// From `from_` towards `towards_`, which fails at the n-th allocation, then to `to_`.
  /// @returns whether the move that was to fail came to its end
  bool fail_and_move_on(std::int64_t nth, std::int64_t how_many) {
    SCOPED_TRACE("allocation " + std::to_string(nth));
    MovingWindow window{OpenedTerrain(store_)};
    window.move_to(from_);
    if (moves(window, towards_, nth, how_many)) {
      EXPECT_TRUE(canonical(window.tin()) == at_towards_);
      return true;
    }
    if (how_many == kThisOne) {  // else there was no memory for T0
      const auto now = canonical(window.tin());
      unchanged_ += now == at_from_ ? 1 : 0;
      begun_again_ += now == at_t0_ ? 1 : 0;
      EXPECT_TRUE(now == at_from_ || now == at_t0_);
    }
    const MoveResult moved = window.move_to(to_);
    EXPECT_TRUE(canonical(window.tin()) == at_to_);
    EXPECT_EQ(moved.vertices, fresh_.vertices);
    EXPECT_EQ(moved.triangles, fresh_.triangles);
    EXPECT_EQ(moved.certificate.error, fresh_.certified_error);
    EXPECT_EQ(moved.certificate.deviation, fresh_.certified_deviation);
    // What is remembered of the pages fits the mesh: all of it can go again.
    window.move_to(any_of({}));
    EXPECT_TRUE(canonical(window.tin()) == at_t0_);
    return false;
  }

  /// @returns how many allocations a move makes
  std::int64_t fail_each(std::int64_t how_many) {
    constexpr std::int64_t kOneByOne = 40, kStride = 3;
    std::int64_t n = 1;
    while (!HasFailure() && !fail_and_move_on(n, how_many)) {
      n += n < kOneByOne ? 1 : kStride;
    }
    return n;
  }

  std::mt19937_64 random_{4};
  Hierarchy hierarchy_ =
      reference::simplify_unmeasured(reference::random_grid(random_, 36, 36, 4, 0.05), random_);
  TemporaryStore file_{hierarchy_};
  std::shared_ptr<const StoreFile> store_ = file_.open();
  Terrain terrain_{store_};
  PredicatePtr from_ = at(5, 60), towards_ = at(40, 110), to_ = at(8, 66);
  RefinedTin fresh_ = fresh(*to_);
  std::vector<reference::Corners> at_from_ = canonical(fresh(*from_).tin),
                                  at_towards_ = canonical(fresh(*towards_).tin),
                                  at_to_ = canonical(fresh_.tin), at_t0_ = canonical(terrain_.t0());
  int unchanged_ = 0, begun_again_ = 0;
};

TEST_F(MovingWindowFaults, OfOneAllocationLeaveTheNextMoveAlone) {
  EXPECT_GT(fail_each(kThisOne), 100);
  // Else the test shows nothing of what it is about.
  EXPECT_GT(unchanged_, 10);
  EXPECT_GT(begun_again_, 10);
}

TEST_F(MovingWindowFaults, OfAllThatFollowLeaveTheNextMoveAlone) {
  EXPECT_GT(fail_each(kAllBehind), 100);
}

}  // namespace
}  // namespace ptin
