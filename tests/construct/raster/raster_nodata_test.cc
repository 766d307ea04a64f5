// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which stored values a nodata value means, and which values are suspect where none is declared.
#include "engine/construct/raster/raster_nodata.h"

#include <cfloat>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/construct/raster/raster_suspects.h"

namespace ptin {
namespace {

bool is_nodata(double stored, double nodata, const StoredType& type) {
  return nodata_range(nodata, type).holds(stored);
}

TEST(NodataRange, OfIntegersIsAValueThatTheTypeHas) {
  EXPECT_TRUE(is_nodata(-32768, -32768, {GDT_Int16}));
  EXPECT_FALSE(is_nodata(-32767, -32768, {GDT_Int16}));
  for (const double none : {32768.0, -9999.5, 1e20, -HUGE_VAL}) {
    EXPECT_TRUE(nodata_range(none, {GDT_Int16}).is_empty()) << none;
  }
  EXPECT_TRUE(nodata_range(-1, {GDT_UInt32}).is_empty());
  EXPECT_TRUE(is_nodata(4294967295.0, 4294967295.0, {GDT_UInt32}));
  EXPECT_TRUE(is_nodata(-9, -9, {GDT_Byte, true}));
  EXPECT_TRUE(nodata_range(-9, {GDT_Byte}).is_empty());
}

TEST(NodataRange, OfFloatsIsWhatTheTypeMakesOfTheValue) {
  constexpr double kStored = static_cast<double>(-9999.9F);
  EXPECT_TRUE(is_nodata(kStored, -9999.9, {GDT_Float32}));
  EXPECT_FALSE(is_nodata(std::nextafter(-9999.9F, 0.0F), -9999.9, {GDT_Float32}));
  EXPECT_TRUE(is_nodata(kStored, -9999.9, {GDT_Float64})) << "a double that was a float once";
  EXPECT_TRUE(is_nodata(-9999.9, -9999.9, {GDT_Float64}));
  EXPECT_FALSE(is_nodata(-9999.8, -9999.9, {GDT_Float64}));
}

TEST(NodataRange, OfHugeValuesHasThreeDigits) {
  for (const double written : {-3.4e38, -3.40282e38, -3.4028235e+38, -3.4028234663852886e+38}) {
    EXPECT_TRUE(is_nodata(-double{FLT_MAX}, written, {GDT_Float32})) << written;
    EXPECT_TRUE(is_nodata(-double{FLT_MAX}, written, {GDT_Float64})) << written;
    EXPECT_FALSE(is_nodata(double{FLT_MAX}, written, {GDT_Float32})) << written;
  }
  EXPECT_TRUE(is_nodata(-DBL_MAX, -1.79769e308, {GDT_Float64}));
  EXPECT_TRUE(is_nodata(-double{FLT_MAX}, -DBL_MAX, {GDT_Float32}));
  EXPECT_TRUE(is_nodata(-HUGE_VAL, -DBL_MAX, {GDT_Float32}));
  EXPECT_FALSE(is_nodata(-HUGE_VAL, -3.4e38, {GDT_Float32})) << "an infinite height is refused";
}

TEST(NodataRange, OfFloatsOfFewerBitsAreThoseOnEitherSide) {
  const StoredType half{GDT_Float32, false, significant_bits_of(GDT_Float32, "16")};
  EXPECT_TRUE(is_nodata(-10000, -9999, half));
  EXPECT_TRUE(is_nodata(-9992, -9999, half));
  EXPECT_FALSE(is_nodata(-9984, -9999, half));
  EXPECT_TRUE(is_nodata(-HUGE_VAL, -3.4e38, half));
  EXPECT_EQ(significant_bits_of(GDT_UInt16, "12"), 0);
}

TEST(NodataRange, IsEmptyWithoutAValueAndForNan) {
  EXPECT_TRUE(nodata_range(std::nullopt, {GDT_Float32}).is_empty());
  EXPECT_TRUE(nodata_range(std::nan(""), {GDT_Float32}).is_empty());
}

std::vector<RasterSuspects::Suspect> suspects_of(const std::vector<float>& values) {
  RasterSuspects all;
  const std::vector<std::uint8_t> valid(values.size(), 1);
  for (std::size_t i = 0; i < values.size(); ++i) {  // as tasks see them, the last one first
    const std::size_t at = values.size() - 1 - i;
    RasterSuspects one;
    const auto value = static_cast<double>(values[at]);
    one.add<float>(std::span(values).subspan(at, 1), std::span(valid).subspan(at, 1), value, value,
                   [&](std::size_t) { return at; });
    all.join(one);
  }
  return all.apart();
}

TEST(RasterSuspects, AreTypicalValuesApartFromAllOthers) {
  const auto found = suspects_of({100, -9999, 120, -9999, 130});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].count, 2U);
  EXPECT_EQ(found[0].first, 1U);
  EXPECT_EQ(found[0].value, -9999);
  EXPECT_EQ(suspects_of({5, -32768, 1e20F, 7}).size(), 2U);
  EXPECT_EQ(suspects_of({-9999, -9999}).size(), 1U);
}

TEST(RasterSuspects, AreNoneAmongOtherValues) {
  EXPECT_TRUE(suspects_of({-9990, -9999, -10010, 300}).empty()) << "an ocean";
  EXPECT_TRUE(suspects_of({-9998, -9999, 0}).empty());
  EXPECT_TRUE(suspects_of({-9998, 1, 9998}).empty());
}

}  // namespace
}  // namespace ptin
