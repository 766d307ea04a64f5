// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/certificate.h"

#include <utility>

#include <gtest/gtest.h>

namespace ptin {
namespace {

StoreFacts facts_of(HeightType type, double step, double error, double deviation) {
  StoreFacts facts;
  facts.heights = {type, step, 0.0};
  facts.min_height = -20.0;
  facts.max_height = 1000.0;
  facts.base_error = error;
  facts.base_deviation = deviation;
  return facts;
}

TEST(LeavesRecordsOut, IsTrueOfWhatNoRoundingMakes) {
  // A raster's whole metres are exact: whatever its file tells was left out, be it less than half a step.
  for (const auto& [error, deviation] :
       {std::pair(0.3, 0.3), std::pair(0.5, 0.5), std::pair(5.0, 0.0), std::pair(0.0, 0.2)}) {
    EXPECT_TRUE(leaves_records_out(facts_of(HeightType::int32, 1.0, error, deviation))) << error;
  }
  EXPECT_FALSE(leaves_records_out(facts_of(HeightType::int32, 1.0, 0.0, 0.0)));
  // Doubles as steps that are finer than floats: half a step is their rounding; a border that was moved is none.
  constexpr double kStep = 0x1p-28;
  EXPECT_FALSE(leaves_records_out(facts_of(HeightType::int32, kStep, kStep / 2, kStep / 2)));
  EXPECT_TRUE(leaves_records_out(facts_of(HeightType::int32, kStep, 1.0, kStep / 2)));
  EXPECT_TRUE(leaves_records_out(facts_of(HeightType::int32, kStep, kStep / 2, 1e-6)));
  // Doubles as floats.
  constexpr double kRounding = 1000 * 0x1p-24;
  EXPECT_FALSE(leaves_records_out(facts_of(HeightType::float32, 0.0, kRounding, kRounding)));
  EXPECT_TRUE(leaves_records_out(facts_of(HeightType::float32, 0.0, 2 * kRounding, kRounding)));
}

}  // namespace
}  // namespace ptin
