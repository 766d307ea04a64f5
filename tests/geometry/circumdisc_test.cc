// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/circumdisc.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

TEST(Circumdisc, IsClosed) {
  const Circumdisc disc({0, 0}, {2, 0}, {0, 2});
  EXPECT_TRUE(disc.holds({2, 2}));
  EXPECT_TRUE(disc.holds({1, 1}));
  EXPECT_FALSE(disc.holds({3, 1}));
  EXPECT_FALSE(disc.holds({0, 3}));
}

TEST(Circumdisc, OfASliverAcrossTheGridIsExact) {
  constexpr std::int32_t m = kGridMax;
  // A disc whose border is nearly a straight line, with the lower right half of the grid inside.
  const Circumdisc disc({0, 0}, {m, m - 1}, {m / 2, m / 2});
  EXPECT_TRUE(disc.holds({0, 0}));
  EXPECT_TRUE(disc.holds({m / 2, m / 2}));
  EXPECT_TRUE(disc.holds({m, 0}));
  EXPECT_FALSE(disc.holds({m / 2, m / 2 + 1}));
  EXPECT_FALSE(disc.holds({0, m}));
  EXPECT_TRUE(disc.may_meet({m, 0, m, 0}));
  EXPECT_FALSE(disc.may_meet({0, m / 2, m / 4, m}));
  EXPECT_TRUE(disc.may_meet({0, 0, m, m}));
}

/// The determinant in 128-bit integers, on coordinates that leave room.
bool holds(GridPoint a, GridPoint b, GridPoint c, GridPoint p) {
  __extension__ using Int = __int128;
  const Int ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y, cx = c.x - p.x,
            cy = c.y - p.y;
  return (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
             (cx * cx + cy * cy) * (ax * by - ay * bx) >=
         0;
}

RC_GTEST_PROP(Circumdisc, AgreesWithTheDeterminantAndMissesNoBox, ()) {
  const int size = *rc::gen::element(5, 40, 1 << 20);
  const auto point = [&] {
    return GridPoint{*rc::gen::inRange(0, size), *rc::gen::inRange(0, size)};
  };
  const GridPoint a = point(), b = point(), c = point();
  RC_PRE(orient(a, b, c) > 0);
  const Circumdisc disc(a, b, c);
  for (int i = 0; i < 40; ++i) {
    const GridPoint p = point();
    RC_ASSERT(disc.holds(p) == holds(a, b, c, p));
    if (disc.holds(p)) {
      RC_ASSERT(disc.may_meet(united(box_of(p), point())));
    }
  }
  // A box that the disc misses by two units is not met.
  GridBox box = united(box_of(point()), point());
  const GridBox wide{box.min_x - 2, box.min_y - 2, box.max_x + 2, box.max_y + 2};
  bool near = false;
  if (size <= 40) {
    for (std::int32_t x = wide.min_x; x <= wide.max_x; ++x) {
      for (std::int32_t y = wide.min_y; y <= wide.max_y; ++y) {
        near = near || holds(a, b, c, {x, y});
      }
    }
    RC_ASSERT(near || !disc.may_meet(box));
  }
}

}  // namespace
}  // namespace ptin
