// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which texts are numbers.
#include "engine/number.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace ptin {
namespace {

TEST(ParseNumber, TakesWholeTextsAlone) {
  for (const char* text :
       {"", " 1", "1 ", "1,5", "0x10", "1m", "e5", "+-1", "-+1", "--1", "+", "-"}) {
    EXPECT_FALSE(parse_number<double>(text)) << text;
    EXPECT_FALSE(parse_number<std::int64_t>(text)) << text;
  }
  EXPECT_EQ(parse_number<double>("12"), 12.0);
  EXPECT_EQ(parse_number<double>("-1.5e3"), -1500.0);
  EXPECT_EQ(parse_number<double>("+.5"), 0.5);
  EXPECT_EQ(parse_number<double>("5."), 5.0);
  EXPECT_TRUE(std::isnan(*parse_number<double>("nan")));
  EXPECT_EQ(parse_number<double>("-inf"), -std::numeric_limits<double>::infinity());
}

TEST(ParseNumber, OfWholeNumbersTakesThoseThatFit) {
  EXPECT_EQ(parse_number<std::int64_t>("-9223372036854775808"), INT64_MIN);
  EXPECT_EQ(parse_number<std::uint64_t>("+18446744073709551615"), UINT64_MAX);
  EXPECT_FALSE(parse_number<std::int64_t>("9223372036854775808"));
  EXPECT_FALSE(parse_number<std::uint64_t>("-1"));
  EXPECT_FALSE(parse_number<std::uint64_t>("1.0"));
}

TEST(ParseNumber, RoundsWhatNoDoubleHasToInfinityOrNothing) {
  constexpr double kTooLarge = std::numeric_limits<double>::infinity();
  for (const std::string text : {"1e999", "1e9999", "1E+99999"}) {
    EXPECT_EQ(parse_number<double>(text), kTooLarge) << text;
    EXPECT_EQ(parse_number<double>("-" + text), -kTooLarge) << text;
  }
  for (const std::string& text :
       {std::string("1e-999"), std::string("1E-99999"), "0." + std::string(400, '0') + "1",
        "-0." + std::string(9000, '0') + "1"}) {
    EXPECT_EQ(parse_number<double>(text), 0.0) << text;
  }
}

TEST(TakeNumber, LeavesWhatStandsBehind) {
  std::string_view text = "50.5cm";
  EXPECT_EQ(take_number<double>(text), 50.5);
  EXPECT_EQ(text, "cm");
  EXPECT_EQ(take_number<double>(text), std::nullopt);
  EXPECT_EQ(text, "cm");
  text = "1e999 m";
  EXPECT_EQ(take_number<double>(text), std::numeric_limits<double>::infinity());
  EXPECT_EQ(text, " m");
}

}  // namespace
}  // namespace ptin
