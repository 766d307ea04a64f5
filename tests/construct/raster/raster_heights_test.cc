// SPDX-License-Identifier: GPL-3.0-or-later
//
// RasterSource: voids, and heights of every type.
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>

#include <cpl_conv.h>
#include <gdal_priv.h>

#include "engine/construct/grid/source_options.h"
#include "tests/construct/raster/raster_fixture.h"

namespace ptin {
namespace {

using namespace raster_fixture;

TEST(RasterSource, TakesTheNodataValueOfTheFileOrTheCaller) {
  Made made = small();
  made.nodata = 5;
  expect_heights(open(made), {4, kVoid, 6, 1, 2, 3});
  SourceOptions options;
  options.nodata = 2;
  const RasterSource source = open(made, options);
  expect_heights(source, {4, 5, 6, 1, kVoid, 3});
  EXPECT_EQ(source.void_samples(), 1U);
}

TEST(RasterSource, LeavesHeightsAloneWhereTheNodataValueDoesNotFitTheType) {
  Made made = small();
  SourceOptions options;
  options.nodata = -99999;
  expect_heights(open(made, options), {4, 5, 6, 1, 2, 3});
  options.nodata = 2.5;
  expect_heights(open(made, options), {4, 5, 6, 1, 2, 3});
}

TEST(RasterSource, TakesNanForNoData) {
  Made made = small();
  made.type = GDT_Float32;
  made.values[1] = kVoid;
  expect_heights(open(made), {4, 5, 6, 1, kVoid, 3});
  made.nodata = kVoid;
  expect_heights(open(made), {4, 5, 6, 1, kVoid, 3});
}

TEST(RasterSource, ComparesANodataValueAsTheTypeHoldsIt) {
  Made made = small();
  made.type = GDT_Float32;
  made.values[0] = -3.4e38;
  made.values[1] = static_cast<double>(-9999.9F);
  SourceOptions options;
  options.nodata = -9999.9;  // not a float32
  expect_heights(open(made, options), {4, 5, 6, static_cast<double>(-3.4e38F), kVoid, 3});
  for (double nodata : {-3.4e38, static_cast<double>(-3.4e38F), -3.4000001e38}) {
    options.nodata = nodata;
    expect_heights(open(made, options), {4, 5, 6, kVoid, static_cast<double>(-9999.9F), 3});
  }
  made.values[0] = -FLT_MAX;
  options.nodata = -3.4028235e+38;  // rounded away from zero, beyond the type
  expect_heights(open(made, options), {4, 5, 6, kVoid, static_cast<double>(-9999.9F), 3});
}

TEST(RasterSource, TakesMaskBandsAndAlphaForVoids) {
  Made made = small();
  made.alpha = {255, 0, 1, 255, 255, 255};
  made.type = GDT_UInt16;
  expect_heights(open(made), {4, 5, 6, 1, kVoid, 3});

  made = small();
  write(made);
  {
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    GDALDatasetUniquePtr data(GDALDataset::Open(made.name.c_str(), GDAL_OF_UPDATE));
    ASSERT_EQ(data->CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::array<std::uint8_t, 6> mask{255, 255, 255, 255, 255, 0};
    ASSERT_EQ(data->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 3, 2, mask.data(), 3,
                                                              2, GDT_Byte, 0, 0, nullptr),
              CE_None);
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
  }
  expect_heights(RasterSource::open({made.name}, {}), {4, 5, kVoid, 1, 2, 3});
}

TEST(RasterSource, RefusesInfiniteHeightsAndNamesThePixel) {
  Made made = small();
  made.type = GDT_Float32;
  made.values[5] = std::numeric_limits<double>::infinity();
  expect_refused(made, "column 2, row 1");
  made.nodata = std::numeric_limits<double>::infinity();
  expect_heights(open(made), {4, 5, kVoid, 1, 2, 3});
  made.nodata.reset();
  made.type = GDT_Float64;
  made.values[5] = -1e39;
  expect_refused(made, "column 2, row 1");
}

TEST(RasterSource, AcceptsARasterThatIsAllVoid) {
  Made made = small();
  made.type = GDT_Float32;
  made.values.assign(6, kVoid);
  const RasterSource source = open(made);
  EXPECT_EQ(source.valid_samples(), 0U);
  EXPECT_GT(source.frame().min_height, source.frame().max_height);
  EXPECT_GT(source.frame().height_quantum, 0);
}

TEST(RasterSource, KeepsEveryIntegerTypeExactly) {
  for (GDALDataType type :
       {GDT_Byte, GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Int64, GDT_UInt64}) {
    Made made = small();
    made.type = type;
    made.values[0] = type == GDT_Byte ? 255 : type == GDT_Int16 ? -32768 : 65535;
    if (type == GDT_UInt16 || type == GDT_Byte) made.nodata = 3;
    const RasterSource source = open(made);
    EXPECT_EQ(source.frame().heights, (HeightEncoding{HeightType::int32, 1, 0}));
    EXPECT_EQ(source.frame().height_rounding, 0);
    EXPECT_EQ(source.frame().height_quantum, 1);
    const double last = made.nodata ? kVoid : 3;
    expect_heights(source, {4, 5, 6, made.values[0], 2, last});
  }
}

TEST(RasterSource, TurnsScaleAndOffsetOfIntegersIntoTheEncoding) {
  Made made = small();
  made.scale = 0.1;
  made.offset = -500;
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().heights, (HeightEncoding{HeightType::int32, 0.1, -500}));
  EXPECT_EQ(source.frame().height_quantum, 0.1);
  expect_heights(source, {-500 + 0.1 * 4, -500 + 0.1 * 5, -500 + 0.1 * 6, -500 + 0.1 * 1,
                          -500 + 0.1 * 2, -500 + 0.1 * 3});
}

TEST(RasterSource, AppliesANegativeScale) {
  Made made = small();
  made.scale = -1;
  made.offset = 10;
  expect_heights(open(made), {6, 5, 4, 9, 8, 7});
}

TEST(RasterSource, AppliesScaleAndOffsetToFloats) {
  Made made = small();
  made.type = GDT_Float32;
  made.scale = 0.5;
  made.offset = 1;
  expect_heights(open(made), {3, 3.5, 4, 1.5, 2, 2.5});
}

TEST(RasterSource, KeepsFloat32AndFindsItsDecimalStep) {
  Made made = small();
  made.type = GDT_Float32;
  made.values = {1.25, 2.5, 3, 304.17, 5, -6.01};
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().heights.type, HeightType::float32);
  EXPECT_EQ(source.frame().height_quantum, 0.01);
  EXPECT_EQ(source.frame().height_rounding, 0);
  expect_heights(source,
                 {static_cast<double>(304.17F), 5, static_cast<double>(-6.01F), 1.25, 2.5, 3});
}

TEST(RasterSource, TakesAPartOfTheRangeForTheQuantumWhereNoDecimalStepFits) {
  Made made = small();
  made.type = GDT_Float32;
  made.values = {0, 65536, 1.0 / 3, 1, 2, 3};
  EXPECT_EQ(open(made).frame().height_quantum, 1);
  made.values = {1000000.125, 1000000.25, 1000001, 1000001.0625, 1000002, 1000003};
  EXPECT_NEAR(open(made).frame().height_quantum, 2.875 / 65536, 1e-9);
}

TEST(RasterSource, KeepsFloat64ThatFitsInt32OrFloat32Exactly) {
  Made made = small();
  made.type = GDT_Float64;
  EXPECT_EQ(open(made).frame().heights, (HeightEncoding{HeightType::int32, 1, 0}));
  made.values[2] = 0.375;
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().heights.type, HeightType::float32);
  expect_heights(source, {4, 5, 6, 1, 2, 0.375});
}

TEST(RasterSource, KeepsFloat64DecimalsInSteps) {
  Made made = small();
  made.type = GDT_Float64;
  made.values = {1234.56, 0.07, -2, 3.1, 4, 5};
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().heights, (HeightEncoding{HeightType::int32, 0.01, 0}));
  EXPECT_LT(source.frame().height_rounding, 1e-12);
  const Heights found = heights_of(source);
  EXPECT_NEAR(found[3], 1234.56, source.frame().height_rounding);
}

TEST(RasterSource, RoundsOtherFloat64ByAtMostTheRoundingItReports) {
  Made made = small();
  made.type = GDT_Float64;
  made.values = {1.0 / 3, 8848.86 / 7, -430.5 / 11, 3.14159265358979, 1e-12, 2000.0 / 3};
  const RasterSource source = open(made);
  const TerrainFrame& frame = source.frame();
  EXPECT_EQ(frame.heights.type, HeightType::int32);
  EXPECT_GT(frame.height_rounding, 0);
  EXPECT_LT(frame.height_rounding, 1e-6);
  const Heights found = heights_of(source);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LE(std::abs(found[i] - made.values[(i + 3) % 6]), frame.height_rounding);
  }
}

TEST(RasterSource, RoundsUInt32BeyondInt32) {
  Made made = small();
  made.type = GDT_UInt32;
  made.values[0] = 4294967295;
  const RasterSource source = open(made);
  const Heights found = heights_of(source);
  EXPECT_LE(std::abs(found[3] - 4294967295.0), source.frame().height_rounding);
  EXPECT_LE(source.frame().height_rounding, 1.0);
}

TEST(RasterSource, NamesTheUnitOfHeights) {
  Made made = small();
  EXPECT_EQ(open(made).frame().vertical_unit, "unknown");
  made.unit = "m";
  EXPECT_EQ(open(made).frame().vertical_unit, "metre");
  made.unit = "ft";
  EXPECT_EQ(open(made).frame().vertical_unit, "foot");
  SourceOptions options;
  options.vertical_crs = "EPSG:5773";
  const RasterSource source = open(made, options);
  EXPECT_TRUE(source.frame().vertical_crs_known);
  EXPECT_EQ(source.frame().vertical_unit, "metre");
}

}  // namespace
}  // namespace ptin
