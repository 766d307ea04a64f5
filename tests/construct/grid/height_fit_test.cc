// SPDX-License-Identifier: GPL-3.0-or-later
//
// The encoding that one pass over heights chooses, and that its rounding bounds every height.
#include "engine/construct/grid/height_fit.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

using Given = HeightScan::Given;

/// k * 10^-decimals, the double nearest to the decimal number.
double decimal(int k, int decimals) {
  const std::string digits = std::to_string(std::abs(k));
  return (k < 0 ? -1 : 1) * std::stod(digits + "e-" + std::to_string(decimals));
}

HeightFit fit_of(const std::vector<double>& heights, Given given = Given::kFloat64) {
  HeightScan scan(given);
  for (const double height : heights) {
    scan.add(height);
  }
  return scan.fit();
}

double largest_rounding(const std::vector<double>& heights, const HeightEncoding& encoding) {
  double largest = 0;
  for (const double height : heights) {
    largest =
        std::max(largest, std::abs(height - encoding.height(encode_height(encoding, height))));
  }
  return largest;
}

/// Every so many whole numbers of hundredths.
std::vector<double> hundredths(int first, int step, int count) {
  std::vector<double> heights;
  for (int i = 0; i < count; ++i) {
    heights.push_back(decimal(first + step * i, 2));
  }
  return heights;
}

/// Hundredths that a step of hundredths gives back bit by bit.
std::vector<double> exact_hundredths(int count) {
  const HeightEncoding encoding{HeightType::int32, 0.01, 0.0};
  std::vector<double> heights;
  for (int k = 101; static_cast<int>(heights.size()) < count; k += 2) {
    const double height = decimal(k, 2);
    if (encoding.height(encode_height(encoding, height)) == height) {
      heights.push_back(height);
    }
  }
  return heights;
}

/// The encoding has so many decimals, and the rounding is the one that there is.
void expect_decimals(const std::vector<double>& heights, int decimals) {
  const HeightFit fit = fit_of(heights);
  EXPECT_EQ(fit.encoding, (HeightEncoding{HeightType::int32, decimal_step(decimals), 0.0}));
  EXPECT_EQ(fit.quantum, decimal_step(decimals));
  EXPECT_EQ(fit.rounding, largest_rounding(heights, fit.encoding));
}

TEST(HeightScan, BoundsTheRoundingOfHeightsThatCameBeforeAFinerOne) {
  for (const int last_decimals : {3, 4}) {
    for (const bool exact : {true, false}) {
      std::vector<double> heights = exact ? exact_hundredths(5000) : hundredths(3, 4, 5000);
      heights.push_back(decimal(5, last_decimals));
      expect_decimals(heights, last_decimals);
      if (last_decimals == 4) {  // thousandths give those of hundredths back, these do not
        EXPECT_GT(fit_of(heights).rounding, 0.0) << "exact as hundredths alone";
      }
    }
  }
}

TEST(HeightScan, BoundsTheRoundingWhateverTheOrder) {
  std::mt19937 random(3);
  std::vector<double> heights = hundredths(-40001, 7, 9000);
  for (int i = 0; i < 30; ++i) {
    heights.push_back(decimal(static_cast<int>(random() % 200'000), i % 5));
  }
  heights.push_back(decimal(77'777'771, 4));
  for (int i = 0; i < 20; ++i) {
    std::shuffle(heights.begin(), heights.end(), random);
    expect_decimals(heights, 4);
  }
}

TEST(HeightScan, RoundsNothingWhereEveryHeightIsGivenBackExactly) {
  const std::vector<double> exact = exact_hundredths(5000);
  const auto expect_exact = [&](const std::vector<double>& first) {
    std::vector<double> heights = first;
    heights.insert(heights.end(), exact.begin(), exact.end());
    expect_decimals(heights, 2);
    EXPECT_EQ(fit_of(heights).rounding, 0.0);
  };
  expect_exact({});
  expect_exact({0, 3, 12, 4096});   // whole
  expect_exact({0.5, 1.5, -20.5});  // of one decimal
  expect_exact({7, 0.5, 0.25});     // finer and finer
}

TEST(HeightScan, LeavesTheRoundingOfCoarserStepsBehind) {
  // In whole numbers and tenths these are far from what they are; in hundredths they are exact.
  const std::vector<double> heights = {1, 2, 2.5, 0.75, 0.01};
  expect_decimals(heights, 2);
  EXPECT_EQ(fit_of(heights).rounding, 0.0);
}

TEST(HeightScan, RoundsWhereAHeightHasTooManyDecimals) {
  std::vector<double> heights = hundredths(3, 4, 2000);
  heights.push_back(decimal(1234567, 5));
  heights.push_back(decimal(11, 2));
  const HeightFit fit = fit_of(heights);
  EXPECT_GT(fit.rounding, 0.0);
  EXPECT_GE(fit.rounding, largest_rounding(heights, fit.encoding));
  EXPECT_LT(fit.rounding, 1e-6);
}

TEST(HeightScan, RoundsWhereStepsAsFineDoNotFit) {
  // A whole number of hundredths fits, of ten thousandths it does not.
  std::vector<double> heights = {decimal(2'000'000'01, 2), decimal(33, 2)};
  expect_decimals(heights, 2);
  heights.push_back(decimal(12345, 4));
  const HeightFit fit = fit_of(heights);
  EXPECT_NE(fit.encoding.step, decimal_step(4));
  EXPECT_GE(fit.rounding, largest_rounding(heights, fit.encoding));
}

TEST(HeightScan, LeavesFloat32AsTheyAre) {
  std::vector<double> heights;
  for (const double height : hundredths(3, 4, 2000)) {
    heights.push_back(static_cast<double>(static_cast<float>(height)));
  }
  const HeightFit fit = fit_of(heights, Given::kFloat32);
  EXPECT_EQ(fit.encoding.type, HeightType::float32);
  EXPECT_EQ(fit.quantum, 0.01);
  EXPECT_EQ(fit.rounding, 0.0);
  heights.push_back(static_cast<double>(1.0625F));
  EXPECT_EQ(fit_of(heights, Given::kFloat32).quantum, 0.0001);
}

}  // namespace
}  // namespace ptin
