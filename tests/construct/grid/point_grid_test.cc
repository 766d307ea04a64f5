// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/point_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

/// Numbers of up to `most` digits after the point, some of them what is left of computed ones.
std::vector<Decimal> some_decimals(int most, std::mt19937& random) {
  std::vector<Decimal> all;
  for (int i = 0; i < 20; ++i) {
    const int decimals = static_cast<int>(random() % static_cast<unsigned>(most + 1));
    std::int64_t mantissa = static_cast<std::int64_t>(random() % 2'000'000) - 1'000'000;
    if (random() % 2 == 0 && decimals >= 6) {
      mantissa = mantissa * 10'000 + static_cast<std::int64_t>(random() % 3);
    }
    all.push_back({mantissa, decimals});
  }
  return all;
}

/// The digits after the point that a decimal has when it is rounded to at most so many.
int decimals_of_rounded(Decimal d, int decimals) {
  if (d.decimals <= decimals) return d.decimals;
  const long double scale = std::pow(10.0L, d.decimals - decimals);
  auto left = static_cast<std::int64_t>(std::round(static_cast<long double>(d.mantissa) / scale));
  for (; decimals > 0 && left % 10 == 0; --decimals) left /= 10;
  return decimals;
}

TEST(DecimalRange, KnowsTheDigitsOfAllRoundedAlsoInParts) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Decimal> all = some_decimals(1 + round % 9, random);
    DecimalRange range, first, second;
    for (std::size_t i = 0; i < all.size(); ++i) {
      range.add(all[i]);
      (i < 7 ? first : second).add(all[i]);
    }
    first.join(second);
    for (int decimals = 0; decimals <= 12; ++decimals) {
      int expected = 0;
      for (const Decimal d : all) expected = std::max(expected, decimals_of_rounded(d, decimals));
      ASSERT_EQ(range.decimals_rounded_to(decimals), expected) << decimals;
      ASSERT_EQ(first.decimals_rounded_to(decimals), expected) << decimals;
    }
  }
}

/// A grid of points of two sources, each on its lattice or on decimals.
PointGrid grid_of(const std::vector<std::optional<SourceLattice>>& lattices,
                  const std::vector<SourcePoint>& points) {
  PointGridScan scan({}, "test");
  for (const auto& lattice : lattices) {
    PointStreamFacts facts;
    facts.plan_decimals = lattice ? 0 : 2;
    facts.lattice = lattice;
    scan.add_source(facts);
  }
  for (const SourcePoint& p : points) scan.add(p);
  return scan.grid();
}

TEST(PointGridScan, KeepsPointsOfTwoLattices) {
  const std::vector<SourcePoint> points = {{{50000001, 2}, {100, 2}, {0, 0}},
                                           {{500000015, 3}, {2005, 3}, {0, 0}},
                                           {{500100015, 3}, {90005, 3}, {0, 0}}};
  const SourceLattice halves{0.01, 500000.005, 0.005}, more{0.01, 500000.105, -3.005};
  const SourceLattice round{0.01, 500000.0, 0.0};
  for (const auto& lattices : {std::vector<std::optional<SourceLattice>>{std::nullopt, halves},
                               {halves, std::nullopt},
                               {round, halves}}) {
    const PointGrid grid = grid_of(lattices, points);
    for (const SourcePoint& p : points) EXPECT_EQ(grid.shift(p), 0.0);
  }
  // Sources of one lattice keep it, wherever their offsets are.
  EXPECT_EQ(grid_of({halves, more}, points).x.unit(), 0.01);
}

TEST(StepCounter, TellsHowFarAValueIsFromItsStep) {
  const StepCounter hundredths(2);
  EXPECT_NEAR(hundredths.rest({12345, 4}), 0.0045, 1e-17);
  EXPECT_NEAR(hundredths.rest({-12345, 4}), -0.0045, 1e-17);
  EXPECT_NEAR(hundredths.rest({1235, 3}), -0.005, 1e-17) << "ties go away from zero";
  EXPECT_EQ(hundredths.rest({125, 2}), 0.0);
  EXPECT_EQ(hundredths.rest({7, 0}), 0.0);
  const StepCounter quarters(0.25, 0.0);
  EXPECT_EQ(quarters.rest({11, 1}), to_double({11, 1}) - 1.0);
}

// Programs write 0.30000000000000004 for 0.3.
TEST(PointGridScan, TakesTheStepsThatAreLeftOfComputedDigits) {
  PointGridScan scan({}, "");
  scan.add_source({});
  scan.add({{0, 0}, {0, 0}, {1, 0}});
  scan.add({{30000000000000004, 17}, {5, 1}, {1, 0}});
  scan.add({{1000, 0}, {1000, 0}, {1, 0}});
  const PointGrid grid = scan.grid();
  EXPECT_TRUE(grid.drops_digits);
  EXPECT_EQ(grid.x.unit(), 0.1);
  EXPECT_EQ(grid.east, 10'000);
}

}  // namespace
}  // namespace ptin
