// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regions on the grid against exact rational tests, and their monotonicity.
#include "engine/query/select/region.h"

#include <cmath>
#include <random>
#include <vector>

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/query/living/stars_in_region.h"
#include "tests/query/random_predicate.h"

namespace ptin {
namespace {

using Kernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using ExactPoint = Kernel::Point_2;

const AffineMap kIdentity{0, 0, 1, 1};

ExactPoint exact(MapPoint p) { return {p.x, p.y}; }
ExactPoint exact(GridPoint p) { return {p.x, p.y}; }

/// Even-odd rule, in exact arithmetic; the border counts as inside.
bool holds(const Polygon& polygon, const ExactPoint& p) {
  bool inside = false;
  for (const auto& ring : polygon.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const ExactPoint a = exact(ring[i]);
      const ExactPoint b = exact(ring[(i + 1) % ring.size()]);
      if (Kernel::Segment_2(a, b).has_on(p)) {
        return true;
      }
      if ((a.y() <= p.y()) != (b.y() <= p.y())) {
        const auto side = CGAL::orientation(a, b, p);
        inside ^= (side == CGAL::LEFT_TURN) == (b.y() > a.y());
      }
    }
  }
  return inside;
}

template <typename Shape>
bool edge_meets(const Polygon& polygon, const Shape& shape) {
  for (const auto& ring : polygon.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const ExactPoint a = exact(ring[i]);
      const ExactPoint b = exact(ring[(i + 1) % ring.size()]);
      if (a == b ? CGAL::do_intersect(a, shape)
                 : CGAL::do_intersect(Kernel::Segment_2(a, b), shape)) {
        return true;
      }
    }
  }
  return false;
}

Kernel::Iso_rectangle_2 exact(const GridBox& b) {
  return {ExactPoint(b.min_x, b.min_y), ExactPoint(b.max_x, b.max_y)};
}

Polygon polygon_of(const Region& region) {
  if (const auto* w = std::get_if<Window>(&region)) {
    return {
        {{{w->min_x, w->min_y}, {w->max_x, w->min_y}, {w->max_x, w->max_y}, {w->min_x, w->max_y}}}};
  }
  if (const auto* p = std::get_if<MapPoint>(&region)) {
    return {{{*p}}};
  }
  if (const auto* s = std::get_if<Segment>(&region)) {
    return {{{s->a, s->b}}};
  }
  return std::get<Polygon>(region);
}

StoreFacts small_domain() {
  StoreFacts facts;
  facts.map = kIdentity;
  facts.bounds = {0, 0, 40, 40};
  return facts;
}

GridBox random_box(std::mt19937_64& random, int side) {
  const auto c = [&] { return static_cast<int>(random() % static_cast<std::uint64_t>(side)); };
  const int x = c();
  const int y = c();
  return {x, y, x + c() / 8, y + c() / 8};
}

RC_GTEST_PROP(GridRegion, AgreesWithExactArithmeticOnBoxes, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Region region = reference::random_region(random, small_domain());
  const Polygon polygon = polygon_of(region);
  const GridRegion on_grid(region, kIdentity);
  for (int i = 0; i < 60; ++i) {
    GridBox box = random_box(random, 40);
    if (box.min_x == box.max_x || box.min_y == box.max_y) {
      ++box.max_x, ++box.max_y;
    }
    const bool meets =
        edge_meets(polygon, exact(box)) || holds(polygon, exact(GridPoint{box.min_x, box.min_y}));
    RC_ASSERT(on_grid.meets(box) == meets);
  }
}

/// Sides at vertices of a fine grid far from its origin, as programs compute them and write them.
TEST(GridRegion, AWindowHoldsTheVerticesOnItsSides) {
  for (const double step : {1e-4, 1e-5}) {
    const AffineMap map{151.20005, -33.9, step, step};
    for (int i = 1; i < 200; ++i) {
      const double side = 151.2 + (i + 0.5) * step + (step == 1e-4 ? 0 : 4.5e-5);
      for (const double at : {side, side * (1 - 4e-15), side * (1 + 4e-15)}) {
        const auto column = static_cast<std::int32_t>(std::lround((side - map.origin_x) / step));
        const Window east{at, -34, 152, -33}, west{151, -34, at, -33};
        for (const Window& window : {east, west}) {
          EXPECT_TRUE(GridRegion(window, map).meets(GridBox{column, 5, column, 5})) << at;
        }
        EXPECT_FALSE(GridRegion(east, map).meets(GridBox{column - 1, 5, column - 1, 5}));
        EXPECT_FALSE(GridRegion(west, map).meets(GridBox{column + 1, 5, column + 1, 5}));
        EXPECT_EQ(on_grid(east, map).min_x, column);
        EXPECT_EQ(snapped(west, map).max_x, map.to_map(column, 0).x);
      }
      const double between = map.to_map(i + 0.25, 0).x;
      EXPECT_EQ(snapped({between, -34, 152, -33}, map).min_x, between);
    }
  }
}

RC_GTEST_PROP(GridRegion, AgreesWithExactArithmeticOnTriangles, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Region region = reference::random_region(random, small_domain());
  const Polygon polygon = polygon_of(region);
  const GridRegion on_grid(region, kIdentity);
  const auto point = [&] {
    return GridPoint{static_cast<int>(random() % 41), static_cast<int>(random() % 41)};
  };
  for (int i = 0; i < 60; ++i) {
    GridPoint a = point();
    GridPoint b = point();
    const GridPoint c = point();
    if (orient(a, b, c) == 0) {
      continue;
    }
    if (orient(a, b, c) < 0) {
      std::swap(a, b);
    }
    const Kernel::Triangle_2 triangle(exact(a), exact(b), exact(c));
    RC_ASSERT(on_grid.meets(a, b, c) ==
              (edge_meets(polygon, triangle) || holds(polygon, exact(a))));
  }
}

/// Map coordinates of a UTM zone, polygons with corners anywhere from near to far beyond the grid.
GridRegion far_region(std::mt19937_64& random, AffineMap& map) {
  map = {500000.25, 4649776.1, 0.3, 0.7};
  Polygon polygon;
  const std::size_t corners = 3 + random() % 20;
  for (std::size_t i = 0; i < corners; ++i) {
    const double far = std::pow(10.0, static_cast<double>(random() % 13));
    const auto c = [&] { return (std::uniform_real_distribution<double>(-1, 1)(random)) * far; };
    const MapPoint p = map.to_map(c(), c());
    if (polygon.rings.empty() || random() % 5 == 0) {
      polygon.rings.emplace_back();
    }
    polygon.rings.back().push_back(p);
  }
  for (auto& ring : polygon.rings) {
    while (ring.size() < 3) {
      ring.push_back(
          map.to_map(static_cast<double>(random() % 1000), static_cast<double>(random() % 1000)));
    }
  }
  return GridRegion(polygon, map);
}

RC_GTEST_PROP(GridRegion, StaysTrueWhenABoxGrows, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  AffineMap map;
  const GridRegion region = far_region(random, map);
  for (int i = 0; i < 200; ++i) {
    const int scale = 1 << (random() % 31);
    const auto c = [&](int most) {
      return static_cast<int>(random() % (static_cast<std::uint64_t>(most) + 1));
    };
    GridBox box{c(scale), c(scale), 0, 0};
    box.max_x = box.min_x, box.max_y = box.min_y;
    bool met = region.meets(box);
    for (int grow = 0; grow < 12; ++grow) {
      const int by = c(1 << (random() % 29));
      switch (random() % 4) {
        case 0:
          box.min_x = std::max(0, box.min_x - by);
          break;
        case 1:
          box.min_y = std::max(0, box.min_y - by);
          break;
        case 2:
          box.max_x =
              static_cast<int>(std::min<std::int64_t>(kGridMax, std::int64_t{box.max_x} + by));
          break;
        default:
          box.max_y =
              static_cast<int>(std::min<std::int64_t>(kGridMax, std::int64_t{box.max_y} + by));
          break;
      }
      const bool meets = region.meets(box);
      RC_ASSERT(meets || !met);
      met = meets;
    }
  }
}

RC_GTEST_PROP(GridRegion, ATriangleThatMeetsLiesInABoxThatMeets, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  AffineMap map;
  const GridRegion region = far_region(random, map);
  for (int i = 0; i < 200; ++i) {
    const std::uint64_t scale = std::uint64_t{2} << (random() % 30);
    const auto c = [&] { return static_cast<int>(random() % scale); };
    const GridPoint t[3] = {{c(), c()}, {c(), c()}, {c(), c()}};
    if (orient(t[0], t[1], t[2]) > 0 && region.meets(t[0], t[1], t[2])) {
      RC_ASSERT(region.meets(united(united(box_of(t[0]), t[1]), t[2])));
    }
  }
}

RC_GTEST_PROP(GridRegion, HoldsTheVerticesOnItsBorderAfterRounding, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const AffineMap map{std::uniform_real_distribution<double>(-1e7, 1e7)(random), 1e6 / 3, 1.0 / 7,
                      1.0 / 3};
  const auto c = [&] { return static_cast<int>(random() % 100000); };
  const GridPoint low{c(), c()};
  const GridPoint high{low.x + c(), low.y + c()};
  const MapPoint a = map.to_map(low.x, low.y);
  const MapPoint b = map.to_map(high.x, high.y);
  for (const Region& region : {Region(Window{a.x, a.y, b.x, b.y}), Region(Segment{a, b}),
                               Region(Polygon{{{a, b, {a.x, b.y}}}})}) {
    const GridRegion on_grid(region, map);
    RC_ASSERT(on_grid.meets(box_of(low)));
    RC_ASSERT(on_grid.meets(box_of(high)));
    RC_ASSERT(!on_grid.meets(GridBox{high.x + 1, high.y + 1, high.x + 2, high.y + 2}));
  }
  RC_ASSERT(GridRegion(a, map).meets(box_of(low)));
}

TEST(GridRegion, AWindowBetweenTwoGridLinesMeetsWhatCrossesItAndNothingElse) {
  const GridRegion region(Window{3.2, 3.2, 3.7, 3.7}, kIdentity);
  EXPECT_TRUE(region.meets(GridBox{3, 3, 4, 4}));
  EXPECT_FALSE(region.meets(GridBox{3, 3, 3, 4}));
  EXPECT_FALSE(region.meets(GridBox{4, 4, 5, 5}));
  EXPECT_TRUE(region.meets({3, 3}, {4, 3}, {3, 4}));
  EXPECT_TRUE(region.meets({4, 4}, {3, 4}, {4, 3}));
  EXPECT_FALSE(GridRegion(Window{3.6, 3.6, 3.7, 3.7}, kIdentity).meets({3, 3}, {4, 3}, {3, 4}));
}

TEST(GridRegion, AHoleIsOutsideAndItsBorderInside) {
  const Polygon polygon{
      {{{0, 0}, {30, 0}, {30, 30}, {0, 30}}, {{10, 10}, {20, 10}, {20, 20}, {10, 20}, {10, 10}}}};
  const GridRegion region(polygon, kIdentity);
  EXPECT_TRUE(region.meets(GridBox{5, 5, 6, 6}));
  EXPECT_FALSE(region.meets(GridBox{12, 12, 18, 18}));
  EXPECT_TRUE(region.meets(GridBox{10, 12, 12, 14}));
  EXPECT_FALSE(region.meets({12, 12}, {18, 12}, {12, 18}));
  EXPECT_TRUE(region.meets({12, 12}, {20, 12}, {12, 18}));
  EXPECT_TRUE(region.meets(GridBox{8, 8, 25, 25})) << "the hole lies within";
}

TEST(GridRegion, ManyEdgesAgreeWithFew) {
  Polygon fine{{{}}};
  for (int i = 0; i < 20000; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 20000;
    fine.rings[0].push_back({500 + 400 * std::cos(angle), 500 + 400 * std::sin(angle)});
  }
  const GridRegion region(fine, kIdentity);
  std::mt19937_64 random(1);
  for (int i = 0; i < 3000; ++i) {
    const GridBox box = random_box(random, 1000);
    const double dx = std::max({0.0, box.min_x - 500.0, 500.0 - box.max_x});
    const double dy = std::max({0.0, box.min_y - 500.0, 500.0 - box.max_y});
    const double distance = std::sqrt(dx * dx + dy * dy);
    if (std::abs(distance - 400) > 0.01) {
      EXPECT_EQ(region.meets(box), distance < 400);
    }
  }
}

/// Teeth that stand side by side on the line y = 0. But for that line each edge crosses every
/// horizontal slab, and there are so many that the lists of the edges by slabs would have more
/// entries than 32 bits count.
struct Teeth {
  static constexpr int kEdges = 1 << 20;
  static constexpr int kStep = 512;  ///< From the foot of a tooth to its tip.
  static constexpr int kTip = 1000;

  [[nodiscard]] static Polygon polygon() {
    Polygon teeth{{{}}};
    teeth.rings[0].reserve(kEdges + 1);
    for (int i = 0; i <= kEdges; ++i) {
      teeth.rings[0].push_back({double(kStep) * i, i % 2 == 0 ? 0.0 : double(kTip)});
    }
    return teeth;
  }
};

TEST(GridRegion, SortsAMillionEdgesFromTheBottomToTheTop) {
  const GridRegion region(Region(Teeth::polygon()), kIdentity);
  // The tip of a tooth in the middle, which beside it is at least 900 high for 40 units.
  constexpr int kTipAt = (Teeth::kEdges / 2 + 1) * Teeth::kStep;
  EXPECT_TRUE(region.contains(GridBox{kTipAt - 40, 800, kTipAt + 40, 900}));
  EXPECT_FALSE(region.contains(GridBox{kTipAt - 40, 900, kTipAt + 40, 990}));
  EXPECT_TRUE(region.meets({kTipAt, 999}, {kTipAt + 2, 1200}, {kTipAt - 2, 1200}));
  // Between it and the next one, where both are below 100.
  constexpr int kGapAt = kTipAt + Teeth::kStep;
  EXPECT_FALSE(region.meets(GridBox{kGapAt - 40, 100, kGapAt + 40, 120}));
  EXPECT_TRUE(region.meets(GridBox{kGapAt - 80, 100, kGapAt + 40, 120}));
  // The last edge.
  constexpr int kEnd = Teeth::kEdges * Teeth::kStep;
  EXPECT_TRUE(region.meets(GridBox{kEnd, 0, kEnd + 9, 1}));
  EXPECT_FALSE(region.meets(GridBox{kEnd + 1, 0, kEnd + 9, Teeth::kTip}));
}

TEST(GridRegion, TellsHowFarItsEdgesAreWidened) {
  const auto triangle = [](double far) {
    return Region(Polygon{{{{0.0, 0.0}, {far, 1.0}, {1.0, far}}}});
  };
  EXPECT_EQ(GridRegion(Region(Window{0, 0, 1e18, 1e18}), kIdentity).widening(), 0.0);
  for (const double far : {10.0, 1e9, 1e12}) {
    const GridRegion region(triangle(far), kIdentity);
    EXPECT_LT(region.widening(), 0.01) << far;
    EXPECT_EQ(StarsInRegion(&region).reach(), region.bounds());
  }
  const GridRegion region(triangle(1e18), kIdentity);
  EXPECT_GT(region.widening(), 1.0);
  EXPECT_EQ(StarsInRegion(&region).reach().min_x, INT32_MIN) << "a directory may not be asked";
}

TEST(GridRegion, RejectsWhatIsNoRegion) {
  const auto rejected = [](const Region& region) {
    try {
      GridRegion(region, kIdentity);
    } catch (const Error& e) {
      return e.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  EXPECT_TRUE(rejected(Window{1, 0, 0, 1}));
  EXPECT_TRUE(rejected(Window{0, 0, INFINITY, 1}));
  EXPECT_TRUE(rejected(Window{0, NAN, 1, 1}));
  EXPECT_TRUE(rejected(MapPoint{NAN, 0}));
  EXPECT_TRUE(rejected(Segment{{0, 0}, {1e300, 0}}));
  EXPECT_TRUE(rejected(Polygon{}));
  EXPECT_TRUE(rejected(Polygon{{{{0, 0}, {1, 0}, {0, 0}}}}));
}

}  // namespace
}  // namespace ptin
