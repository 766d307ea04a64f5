// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/hilbert.h"

#include <cstdlib>
#include <map>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

namespace ptin::test {
namespace {

TEST(HilbertPosition, VisitsEveryCellOfASquareOnceByStepsOfOne) {
  constexpr int kSide = 64;
  std::map<std::uint64_t, std::pair<int, int>> cells;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      cells[hilbert_position(x, y)] = {x, y};
    }
  }
  ASSERT_EQ(cells.size(), std::size_t{kSide} * kSide);
  EXPECT_EQ(cells.begin()->first, 0U);
  EXPECT_EQ(cells.rbegin()->first, std::uint64_t{kSide} * kSide - 1);
  for (auto it = cells.begin(), next = std::next(it); next != cells.end(); ++it, ++next) {
    const int step = std::abs(it->second.first - next->second.first) +
                     std::abs(it->second.second - next->second.second);
    ASSERT_EQ(step, 1) << "at position " << it->first;
  }
}

// Inverse of hilbert_position, by search: the quadrant whose corner has the right leading bits.
std::pair<std::uint32_t, std::uint32_t> cell_at(std::uint64_t position) {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  for (int bit = 31; bit >= 0; --bit) {
    for (unsigned quadrant = 0; quadrant < 4; ++quadrant) {
      const std::uint32_t qx = x | (quadrant & 1U) << bit;
      const std::uint32_t qy = y | (quadrant >> 1U) << bit;
      if (hilbert_position(qx, qy) >> (2 * bit) == position >> (2 * bit)) {
        x = qx;
        y = qy;
        break;
      }
    }
  }
  return {x, y};
}

RC_GTEST_PROP(HilbertPosition, IsABijectionOnTheWholeRange, (std::uint64_t position)) {
  const auto [x, y] = cell_at(position);
  RC_ASSERT(hilbert_position(x, y) == position);
}

RC_GTEST_PROP(HilbertPosition, NeighboursAlongTheCurveShareASide, (std::uint64_t position)) {
  RC_PRE(position != UINT64_MAX);
  const auto [ax, ay] = cell_at(position);
  const auto [bx, by] = cell_at(position + 1);
  const auto apart = [](std::uint32_t a, std::uint32_t b) { return a > b ? a - b : b - a; };
  RC_ASSERT(std::uint64_t{apart(ax, bx)} + apart(ay, by) == 1U);
}

RC_GTEST_PROP(HilbertCell, IsTheInverse, (std::uint32_t x, std::uint32_t y)) {
  RC_ASSERT(hilbert_cell(hilbert_position(x, y)) == (HilbertCell{x, y}));
}

}  // namespace
}  // namespace ptin::test
