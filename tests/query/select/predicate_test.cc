// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monotone predicates: what each means, and that none ever turns from true to false while its
// arguments grow.
#include "engine/query/select/predicate.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "tests/query/random_predicate.h"

namespace ptin {
namespace {

const HeightEncoding kHeights{HeightType::int32, 0.1, 3.3};

StoreFacts domain() {
  StoreFacts facts;
  facts.map = {700000.1, -3000.7, 0.37, 0.91};
  facts.heights = kHeights;
  facts.bounds = {0, 0, 3000, 2000};
  facts.min_height = -10;
  facts.max_height = 400;
  return facts;
}

Attributes random_attributes(std::mt19937_64& random) {
  const auto below = [&](int n) {
    return static_cast<int>(random() % static_cast<std::uint64_t>(n));
  };
  Attributes a;
  a.roi.min_x = below(3000), a.roi.max_x = a.roi.min_x + below(20);
  a.roi.min_y = below(2000), a.roi.max_y = a.roi.min_y + below(20);
  if (random() % 10 != 0) {
    a.heights.lo = below(4000) - 100;
    a.heights.hi = a.heights.lo + below(30);
  }
  a.error = static_cast<float>(std::exp(std::uniform_real_distribution<double>(-8, 5)(random)));
  a.error = random() % 12 == 0 ? 0.0 : (random() % 20 == 0 ? kInfinity : a.error);
  a.deviation = a.error * 1.5;
  return a;
}

/// One argument grows: by a hair or by much.
void grow(std::mt19937_64& random, Attributes& a) {
  const int by = 1 + static_cast<int>(random() % (1u << (random() % 11)));
  const double hair = random() % 2 == 0 ? by : 1;
  switch (random() % 7) {
    case 0:
      a.roi.min_x = std::max(0, a.roi.min_x - by);
      break;
    case 1:
      a.roi.min_y = std::max(0, a.roi.min_y - by);
      break;
    case 2:
      a.roi.max_x += by;
      break;
    case 3:
      a.roi.max_y += by;
      break;
    case 4:
      a.heights = united(a.heights, is_empty(a.heights) ? 100.0 : a.heights.lo - hair);
      break;
    case 5:
      a.heights = united(a.heights, is_empty(a.heights) ? 100.0 : a.heights.hi + hair);
      break;
    default:
      a.error = random() % 2 == 0 ? std::nextafter(a.error, kInfinity) : a.error * 1.5 + 0.01;
      a.deviation = std::max(a.deviation, a.error);
  }
}

RC_GTEST_PROP(Predicate, NeverTurnsFalseWhileItsArgumentsGrow, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20; ++i) {
    const PredicatePtr p = reference::random_predicate(random, domain(), 3);
    for (int k = 0; k < 20; ++k) {
      Attributes a = random_attributes(random);
      bool held = p->holds(a);
      for (int step = 0; step < 25; ++step) {
        grow(random, a);
        const bool holds = p->holds(a);
        RC_ASSERT(holds || !held);
        RC_ASSERT(!holds || meets(a.roi, p->reach()));
        held = holds;
      }
    }
  }
}

/// Attributes that a record could have below a page or node with `all`.
Attributes within(std::mt19937_64& random, const Attributes& all, double least_error) {
  const auto between = [&](double lo, double hi) {
    return random() % 4 == 0 || !std::isfinite(hi)
               ? (random() % 2 == 0 ? lo : hi)
               : std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const auto range = [&](int lo, int hi, std::int32_t& low, std::int32_t& high) {
    low = static_cast<int>(between(lo, hi));
    high = static_cast<int>(between(low, hi));
  };
  Attributes a;
  range(all.roi.min_x, all.roi.max_x, a.roi.min_x, a.roi.max_x);
  range(all.roi.min_y, all.roi.max_y, a.roi.min_y, a.roi.max_y);
  if (!is_empty(all.heights) && random() % 4 != 0) {
    a.heights.lo = between(all.heights.lo, all.heights.hi);
    a.heights.hi = between(a.heights.lo, all.heights.hi);
  }
  a.error = between(least_error, all.error);
  a.deviation = all.deviation;
  return a;
}

RC_GTEST_PROP(Predicate, HoldsForEachWhereItHoldsForAll, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  int certain = 0;
  for (int i = 0; i < 300; ++i) {
    const PredicatePtr p = reference::random_predicate(random, domain(), 2);
    for (int k = 0; k < 10; ++k) {
      const Attributes all = random_attributes(random);
      const double least = random() % 2 == 0 ? 0.0 : all.error * 0.7;
      if (!p->holds_for_all(all, least)) {
        continue;
      }
      ++certain;
      for (int step = 0; step < 20; ++step) {
        const Attributes a = within(random, all, least);
        RC_ASSERT(p->holds(a));
        RC_ASSERT(p->holds_for_all(a, a.error));
      }
    }
  }
  RC_ASSERT(certain > 50);
}

/// A distance by hypot, not monotone, would be found by the property above only with luck; so the
/// view is driven along boxes that grow by single units, where the last place decides.
TEST(SeenFrom, StaysTrueWhereTheLastPlaceDecides) {
  std::mt19937_64 random(7);
  const StoreFacts f = domain();
  for (int i = 0; i < 20000; ++i) {
    View view;
    view.eye = f.map.to_map(-static_cast<double>(random() % 100000) / 7,
                            -static_cast<double>(random() % 100000) / 3);
    view.eye_height = static_cast<double>(random() % 1000) / 9;
    view.tau = 1.0;
    const PredicatePtr p = seen_from(view, f.map, f.heights);
    Attributes a = random_attributes(random);
    a.heights = united(a.heights, 100.0);
    // Find the error at which the predicate turns, bit by bit, then grow the box.
    double low = 0.0;
    double high = 1e9;
    while (std::nextafter(low, kInfinity) < high) {
      a.error = low + (high - low) / 2;
      if (a.error == low) {
        break;
      }
      (p->holds(a) ? high : low) = a.error;
    }
    a.error = high;
    ASSERT_TRUE(p->holds(a));
    a.roi.min_x = std::max(0, a.roi.min_x - 1);
    ASSERT_TRUE(p->holds(a));
    a.roi.min_y = std::max(0, a.roi.min_y - 1);
    ASSERT_TRUE(p->holds(a));
  }
}

Attributes at(double x, double y, double lo, double hi, double error) {
  Attributes a;
  a.roi = {static_cast<int>(x), static_cast<int>(y), static_cast<int>(x) + 1,
           static_cast<int>(y) + 1};
  a.heights = {lo, hi};
  a.error = error;
  return a;
}

TEST(Reach, IsThatOfTheSmallestPart) {
  const AffineMap map = domain().map;
  const PredicatePtr small = meets_region(Window{10, 20, 30, 40}, map);
  const PredicatePtr both =
      all_of({meets_region(Window{0, 0, 1000, 1000}, map), small, error_above(1.0)});
  EXPECT_EQ(both->reach(), small->reach());
  EXPECT_FALSE(contains(small->reach(), everything()->reach()));
  EXPECT_TRUE(contains(everything()->reach(), any_of({small})->reach()));
}

TEST(ErrorAbove, IsStrict) {
  EXPECT_FALSE(error_above(2.0)->holds(at(0, 0, 0, 0, 2.0)));
  EXPECT_TRUE(error_above(2.0)->holds(at(0, 0, 0, 0, std::nextafter(2.0, 3.0))));
  EXPECT_FALSE(error_above(0.0)->holds(at(0, 0, 0, 0, 0.0)));
  EXPECT_TRUE(error_above(1e300)->holds(at(0, 0, 0, 0, kInfinity)));
  EXPECT_FALSE(error_above(kInfinity)->holds(at(0, 0, 0, 0, kInfinity)));
}

TEST(AboveError, SpeaksOfManyRecordsInCompositionsToo) {
  const auto above = [](double bound) { return std::make_shared<AboveError>(bound); };
  const PredicatePtr both = all_of({everything(), above(2.0)});
  EXPECT_FALSE(both->holds_for_all(at(0, 0, 0, 0, 9.0), 2.0));
  EXPECT_TRUE(both->holds_for_all(at(0, 0, 0, 0, 9.0), std::nextafter(2.0, 3.0)));
  EXPECT_TRUE(above(-1.0)->holds(at(0, 0, 0, 0, 0.0)));
  EXPECT_FALSE(above(kInfinity)->holds(at(0, 0, 0, 0, kInfinity)));
}

TEST(ContainsHeight, ComparesDecodedHeightsClosed) {
  const HeightEncoding metres{HeightType::int32, 0.5, 100.0};
  EXPECT_TRUE(contains_height(105.0, metres)->holds(at(0, 0, 10, 20, 0)));
  EXPECT_TRUE(contains_height(110.0, metres)->holds(at(0, 0, 10, 20, 0)));
  EXPECT_FALSE(contains_height(110.1, metres)->holds(at(0, 0, 10, 20, 0)));
  EXPECT_FALSE(contains_height(107.0, metres)->holds(at(0, 0, kInfinity, -kInfinity, 0)))
      << "all void";
}

TEST(HeightsMeet, TakesInfiniteEnds) {
  const HeightEncoding metres;
  EXPECT_TRUE(heights_meet(-kInfinity, 5.0, metres)->holds(at(0, 0, 5, 20, 0)));
  EXPECT_FALSE(heights_meet(-kInfinity, 4.9, metres)->holds(at(0, 0, 5, 20, 0)));
  EXPECT_TRUE(heights_meet(20, kInfinity, metres)->holds(at(0, 0, 5, 20, 0)));
}

TEST(SeenFrom, MeasuresInGroundUnitsToTheBoxOfRoiAndHeights) {
  const AffineMap map{0, 0, 2, 2};
  View view{{0, 0}, std::nullopt, 0.1, 1.0, 1.0};
  const HeightEncoding metres;
  EXPECT_FALSE(seen_from(view, map, metres)->holds(at(30, 40, 0, 0, 9.9)));
  EXPECT_TRUE(seen_from(view, map, metres)->holds(at(30, 40, 0, 0, 10.1)));
  view.eye_height = 100 + 75;
  EXPECT_FALSE(seen_from(view, map, metres)->holds(at(30, 40, 0, 100, 12.4)));
  EXPECT_TRUE(seen_from(view, map, metres)->holds(at(30, 40, 0, 100, 12.6)));
  view.eye_height.reset();
  view.ground_per_map_x = view.ground_per_map_y = 111000;
  EXPECT_FALSE(seen_from(view, map, metres)->holds(at(30, 40, 0, 0, 1.0e6)));
}

TEST(SeenFrom, InsideOfTheBoxEveryErrorShows) {
  const View view{{5, 5}, std::nullopt, 1.0, 1.0, 1.0};
  Attributes a = at(4, 4, 0, 0, 1e-30);
  a.roi.max_x = a.roi.max_y = 6;
  EXPECT_TRUE(seen_from(view, {}, {})->holds(a));
  a.error = 0;
  EXPECT_FALSE(seen_from(view, {}, {})->holds(a));
}

TEST(Compositions, AreEverythingAndNothingWhenEmpty) {
  EXPECT_TRUE(everything()->holds({}));
  EXPECT_TRUE(all_of({})->holds({}));
  EXPECT_FALSE(any_of({})->holds({}));
}

TEST(Compositions, OfOnePartAreThatPart) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 200; ++i) {
    const PredicatePtr part = reference::random_predicate(random, domain(), 2);
    for (const PredicatePtr& composed : {all_of({part}), any_of({part})}) {
      EXPECT_EQ(composed->reach(), part->reach());
      for (int k = 0; k < 20; ++k) {
        const Attributes a = random_attributes(random);
        EXPECT_EQ(composed->holds(a), part->holds(a));
        EXPECT_EQ(composed->holds_for_all(a, a.error / 2), part->holds_for_all(a, a.error / 2));
      }
    }
  }
}

/// Tells nothing of many records at once.
class OnTheLeft final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.roi.min_x < 1000;
  }
};

TEST(Compositions, OfOnePartAreNoMoreCertainThanIt) {
  const PredicatePtr part = std::make_shared<OnTheLeft>();
  for (const PredicatePtr& composed : {all_of({part}), any_of({part})}) {
    EXPECT_FALSE(composed->holds_for_all(at(0, 0, 0, 0, 1), 1));
    EXPECT_TRUE(composed->holds(at(0, 0, 0, 0, 1)));
    EXPECT_FALSE(composed->holds(at(1000, 0, 0, 0, 1)));
  }
}

TEST(Compositions, OfOnePartKeepItAliveAndRefuseNull) {
  const PredicatePtr both = [] { return any_of({all_of({error_above(1.0)})}); }();
  EXPECT_TRUE(both->holds(at(0, 0, 0, 0, 2.0)));
  EXPECT_FALSE(both->holds(at(0, 0, 0, 0, 1.0)));
  EXPECT_THROW(static_cast<void>(any_of({nullptr})), Error);
}

TEST(Compositions, KeepTheirPartsAlive) {
  PredicatePtr p;
  {
    const PredicatePtr a = error_above(1.0);
    p = all_of({any_of({a, contains_height(5, {})}), meets_region(Window{0, 0, 9, 9}, {})});
  }
  EXPECT_TRUE(p->holds(at(1, 1, 0, 1, 2.0)));
  EXPECT_TRUE(p->holds(at(1, 1, 4, 6, 0.5)));
  EXPECT_FALSE(p->holds(at(1, 1, 0, 1, 0.5)));
  EXPECT_FALSE(p->holds(at(20, 1, 0, 1, 2.0)));
}

TEST(Predicates, RejectValuesOutsideOfTheirContract) {
  const auto code = [](const auto& make) {
    try {
      (void)make();
    } catch (const Error& e) {
      return e.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code([] { return error_above(-1); }), ErrorCode::invalid_argument);
  EXPECT_EQ(code([] { return error_above(NAN); }), ErrorCode::invalid_argument);
  EXPECT_EQ(code([] { return contains_height(kInfinity, {}); }), ErrorCode::invalid_argument);
  EXPECT_EQ(code([] { return heights_meet(2, 1, {}); }), ErrorCode::invalid_argument);
  EXPECT_EQ(code([] { return heights_meet(NAN, 1, {}); }), ErrorCode::invalid_argument);
  EXPECT_EQ(code([] {
              return seen_from(View{{0, NAN}, {}, 1, 1, 1}, {}, {});
            }),
            ErrorCode::invalid_argument);
  EXPECT_EQ(code([] {
              return seen_from(View{{0, 0}, {}, -1, 1, 1}, {}, {});
            }),
            ErrorCode::invalid_argument);
  EXPECT_EQ(code([] {
              return seen_from(View{{0, 0}, {}, 1, 0, 1}, {}, {});
            }),
            ErrorCode::invalid_argument);
  EXPECT_EQ(code([] { return all_of({nullptr}); }), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace ptin
