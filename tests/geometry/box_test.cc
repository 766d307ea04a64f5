// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/box.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/geometry/affine.h"
#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"

namespace ptin {
namespace {

GridBox random_box() {
  const int x = *rc::gen::inRange(0, 20);
  const int y = *rc::gen::inRange(0, 20);
  return {x, y, x + *rc::gen::inRange(0, 8), y + *rc::gen::inRange(0, 8)};
}

bool holds(const GridBox& b, int x, int y) { return contains(b, GridPoint{x, y}); }

RC_GTEST_PROP(GridBox, MeetsWhenSomePointLiesInBoth, ()) {
  const GridBox a = random_box();
  const GridBox b = random_box();
  bool shared = false;
  bool all = true;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 30; ++x) {
      shared |= holds(a, x, y) && holds(b, x, y);
      all &= !holds(b, x, y) || holds(a, x, y);
      RC_ASSERT(!holds(a, x, y) || holds(united(a, b), x, y));
    }
  }
  RC_ASSERT(meets(a, b) == shared);
  RC_ASSERT(contains(a, b) == all);
  RC_ASSERT(contains(united(a, b), a));
  RC_ASSERT(united(a, b) == united(b, a));
}

TEST(GridBox, EmptyIsTheNeutralElementOfUnion) {
  const GridBox empty;
  EXPECT_TRUE(is_empty(empty));
  const GridBox b{1, 2, 3, 4};
  EXPECT_EQ(united(empty, b), b);
  EXPECT_EQ(united(b, empty), b);
  EXPECT_FALSE(meets(empty, b));
  EXPECT_EQ(united(empty, GridPoint{5, 6}), (GridBox{5, 6, 5, 6}));
}

TEST(GridBox, SharesItsBorderAndItsCorners) {
  EXPECT_TRUE(meets(GridBox{0, 0, 2, 2}, GridBox{2, 2, 3, 3}));
  EXPECT_TRUE(meets(GridBox{0, 0, 2, 2}, GridBox{2, 0, 3, 3}));
  EXPECT_FALSE(meets(GridBox{0, 0, 2, 2}, GridBox{3, 0, 4, 3}));
}

TEST(GridBox, HalfPerimeterOfTheWholeGridDoesNotOverflow) {
  EXPECT_EQ(half_perimeter(GridBox{0, 0, kGridMax, kGridMax}), std::int64_t{1} << 31);
}

TEST(Interval, EmptyIsTheNeutralElementOfUnion) {
  const Interval empty;
  EXPECT_TRUE(is_empty(empty));
  const Interval i{-1.5, 2.0};
  EXPECT_EQ(united(empty, i), i);
  EXPECT_FALSE(contains(empty, 0.0));
  EXPECT_TRUE(contains(i, empty));
  EXPECT_FALSE(meets(empty, i));
  EXPECT_EQ(united(empty, 3.0), (Interval{3.0, 3.0}));
}

RC_GTEST_PROP(Interval, MeetsAndContainsFollowTheirEnds, (int a, int b, int c, int d)) {
  const Interval i{static_cast<double>(std::min(a, b)), static_cast<double>(std::max(a, b))};
  const Interval j{static_cast<double>(std::min(c, d)), static_cast<double>(std::max(c, d))};
  RC_ASSERT(meets(i, j) == meets(j, i));
  RC_ASSERT(meets(i, j) == (contains(i, j.lo) || contains(j, i.lo)));
  RC_ASSERT(contains(i, j) == (contains(i, j.lo) && contains(i, j.hi)));
  RC_ASSERT(contains(united(i, j), i) && contains(united(i, j), j));
}

RC_GTEST_PROP(HeightEncoding, GivesEveryInt32Back, (std::int32_t v)) {
  const HeightEncoding heights{HeightType::int32, 0.01, -20.0};
  RC_ASSERT(heights.code(heights.bits(v)) == v);
}

RC_GTEST_PROP(HeightEncoding, IsMonotoneInTheCode, (std::int32_t a, std::int32_t b)) {
  const HeightEncoding heights{HeightType::int32, 0.1, 1234.56};
  RC_ASSERT(heights.height_of_code(std::min(a, b)) <= heights.height_of_code(std::max(a, b)));
}

TEST(HeightEncoding, FloatsAreKeptBitForBit) {
  const HeightEncoding heights;
  for (const float f : {0.0F, -0.0F, 1.5F, 8848.86F, std::numeric_limits<float>::denorm_min()}) {
    EXPECT_EQ(heights.height(heights.bits(f)), static_cast<double>(f));
  }
}

RC_GTEST_PROP(AffineMap, ThereAndBackStaysWithinRounding, ()) {
  const AffineMap map{500000.25, 4649776.5, 30.0, 10.0};
  const double x = *rc::gen::inRange(0, kGridMax);
  const double y = *rc::gen::inRange(0, kGridMax);
  const MapPoint back = map.to_grid(map.to_map(x, y));
  RC_ASSERT(std::abs(back.x - x) < 1e-6);
  RC_ASSERT(std::abs(back.y - y) < 1e-6);
}

}  // namespace
}  // namespace ptin
