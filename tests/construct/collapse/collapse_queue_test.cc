// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/collapse_queue.h"

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/geometry/infinity.h"

namespace ptin {
namespace {

TEST(ErrorClass, IsAThirdOfAnOctaveWide) {
  EXPECT_EQ(error_class(0.0), 0U);
  EXPECT_EQ(error_class(std::nextafter(1.0, 0.0)), 0U);
  EXPECT_EQ(error_class(1.0), 1U);
  for (int third = 0; third < 200; ++third) {
    const double lower = std::exp2(third / 3.0);
    EXPECT_EQ(error_class(lower * (1 + 1e-12)), 2U + static_cast<unsigned>(third));
    EXPECT_EQ(error_class(std::exp2((third + 1) / 3.0) * (1 - 1e-12)),
              2U + static_cast<unsigned>(third));
  }
  for (int octave = 1; octave < 60; ++octave) {  // a whole power of two ends a class
    EXPECT_EQ(error_class(std::exp2(octave)), 1U + 3U * static_cast<unsigned>(octave));
  }
  EXPECT_GT(error_class(kInfinity), error_class(std::numeric_limits<double>::max()));
}

RC_GTEST_PROP(ErrorClass, NeverFallsWhenTheErrorGrows, (double a, double b)) {
  RC_ASSERT(error_class(std::min(std::abs(a), std::abs(b))) <=
            error_class(std::max(std::abs(a), std::abs(b))));
}

CollapseMeasure measure(double error, double height, std::int32_t side) {
  return {{100, 100}, error, height, {90, 90, 90 + side, 90 + side}};
}

TEST(PriorityScale, PutsErrorClassesBeforeBoxes) {
  const PriorityScale scale(CostModel::kError, {0, 0, 1000, 1000}, 1000000);
  EXPECT_LT(scale(measure(0.5, 9, 400)), scale(measure(1.5, 0, 20)));
  EXPECT_LT(scale(measure(1.5, 9, 20)), scale(measure(1.51, 0, 400)));
  EXPECT_LT(scale(measure(1e30, 9, 400)), scale(measure(kInfinity, 0, 20)));
  EXPECT_LT(scale(measure(kInfinity, 9, 20)), scale(measure(kInfinity, 0, 21)));
}

TEST(PriorityScale, PutsShortChainsFirstWhereBoxesAreNearlyEqual) {
  const PriorityScale scale(CostModel::kError, {0, 0, 1 << 20, 1 << 20}, 1000000);
  const auto with_chain = [](std::int32_t side, std::uint32_t chain) {
    CollapseMeasure m = measure(0.0, 0.0, side);
    m.chain = chain;
    return m;
  };
  EXPECT_LT(scale(with_chain(1010, 3)), scale(with_chain(1000, 4)));
  EXPECT_LT(scale(with_chain(1000, 4)), scale(with_chain(1010, 4)));
  EXPECT_LT(scale(with_chain(1000, 9)), scale(with_chain(1200, 3)));
  EXPECT_EQ(scale(with_chain(1000, 5000)), scale(with_chain(1000, 60000)));
  for (std::int32_t side = 1; side < 500000; side += 1 + side / 7) {
    EXPECT_LT(scale(with_chain(side, 60000)), scale(with_chain(side + 1 + side / 8, 0)));
  }
}

TEST(PriorityScale, PutsSmallBoxesFirstForRoi) {
  const PriorityScale scale(CostModel::kRoi, {0, 0, kGridMax, kGridMax}, 1000);
  for (std::int32_t side = 1; side < 100000; side += 1 + side / 3) {
    EXPECT_LT(scale(measure(9, 9, side)), scale(measure(0, 0, side + 1)));
  }
}

TEST(PriorityScale, PutsSmallHeightIntervalsThenBoxesFirstForElevation) {
  const PriorityScale scale(CostModel::kElevation, {0, 0, 1000, 1000}, 1000);
  EXPECT_LT(scale(measure(9, 0.0, 300)), scale(measure(0, 1.0, 20)));
  EXPECT_LT(scale(measure(9, 1.0, 300)), scale(measure(0, 2.0, 20)));
  EXPECT_LT(scale(measure(9, 2.0, 20)), scale(measure(0, 2.0, 300)));
  EXPECT_LT(scale(measure(9, 1e30, 20)), scale(measure(0, 2e30, 20)));
}

RC_GTEST_PROP(CollapseQueue, GivesTheLeastEntryFirst, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  CollapseQueue queue;
  std::set<QueueEntry> expected;
  VertexId next = 0;
  const int spread = static_cast<int>(random() % 64);
  for (int step = 0; step < 400; ++step) {
    if (expected.empty() || random() % 5 < 2) {
      const QueueEntry entry{random() >> spread, next++};
      queue.push(entry);
      expected.insert(entry);
    } else {
      RC_ASSERT(!queue.empty());
      RC_ASSERT(queue.top() == *expected.begin());
      queue.pop();
      expected.erase(expected.begin());
    }
  }
  while (!expected.empty()) {
    RC_ASSERT(!queue.empty());
    RC_ASSERT(queue.top() == *expected.begin());
    queue.pop();
    expected.erase(expected.begin());
  }
  RC_ASSERT(queue.empty());
}

}  // namespace
}  // namespace ptin
