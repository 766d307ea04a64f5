// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/orient.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

GridPoint random_point() {
  // Corners of the grid and near points come often: there signs are hardest and products largest.
  const auto coordinate = rc::gen::oneOf(rc::gen::element(0, 1, kGridMax - 1, kGridMax),
                                         rc::gen::inRange(0, 4), rc::gen::inRange(0, kGridMax + 1));
  return {*coordinate, *coordinate};
}

__extension__ typedef __int128 Wide;

int sign(Wide v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); }
int sign_of(std::int64_t v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); }

TEST(Orient, IsPositiveCounterClockwiseWithXToTheEastAndYToTheNorth) {
  EXPECT_EQ(orient({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient({0, 0}, {3, 0}, {0, 4}), 12) << "twice the area";
}

TEST(Orient, HoldsItsBoundAtTheCornersOfTheGrid) {
  constexpr std::int64_t kLargest = std::int64_t{1} << 60;
  EXPECT_EQ(orient({0, 0}, {kGridMax, 0}, {kGridMax, kGridMax}), kLargest);
  EXPECT_EQ(orient({kGridMax, kGridMax}, {kGridMax, 0}, {0, 0}), -kLargest);
  EXPECT_EQ(orient({0, kGridMax}, {kGridMax, 0}, {kGridMax, kGridMax}), kLargest);
}

TEST(Orient, TellsAUnitFromALineAcrossTheWholeGrid) {
  EXPECT_EQ(orient({0, 0}, {kGridMax, kGridMax}, {kGridMax / 2, kGridMax / 2}), 0);
  EXPECT_GT(orient({0, 0}, {kGridMax, kGridMax}, {kGridMax / 2, kGridMax / 2 + 1}), 0);
  EXPECT_LT(orient({0, 0}, {kGridMax, kGridMax}, {kGridMax / 2 + 1, kGridMax / 2}), 0);
}

RC_GTEST_PROP(Orient, KeepsItsLaws, ()) {
  const GridPoint a = random_point();
  const GridPoint b = random_point();
  const GridPoint c = random_point();
  RC_ASSERT(orient(a, b, c) == orient(b, c, a));
  RC_ASSERT(orient(a, b, c) == -orient(b, a, c));
  RC_ASSERT(orient(a, a, c) == 0);
}

RC_GTEST_PROP(Orient, AgreesWithWiderArithmetic, ()) {
  const GridPoint a = random_point();
  const GridPoint b = random_point();
  const GridPoint c = random_point();
  const auto wide = [](std::int32_t v) { return static_cast<Wide>(v); };
  const Wide exact = (wide(b.x) - a.x) * (wide(c.y) - a.y) - (wide(b.y) - a.y) * (wide(c.x) - a.x);
  RC_ASSERT(sign_of(orient(a, b, c)) == sign(exact));
  RC_ASSERT(static_cast<Wide>(orient(a, b, c)) == exact);
}

RC_GTEST_PROP(VertexKey, GivesItsPointBackAndOrdersByYThenX, ()) {
  const GridPoint a = random_point();
  const GridPoint b = random_point();
  RC_ASSERT(point_of(key_of(a)) == a);
  RC_ASSERT((key_of(a) < key_of(b)) == (std::pair(a.y, a.x) < std::pair(b.y, b.x)));
  RC_ASSERT(key_of(a) != kNoVertexKey);
}

}  // namespace
}  // namespace ptin
