// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters of every kind are made in GDAL's memory files, so that each test shows what it reads.
#include "engine/construct/raster_source.h"

#include <array>
#include <cfloat>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <tuple>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <sys/resource.h>

#include "engine/error.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

/// A raster to be written; row 0 is the file's first row.
struct Made {
  int columns = 0, rows = 0;
  std::vector<double> values;
  GDALDataType type = GDT_Int16;
  std::optional<std::array<double, 6>> geotransform =
      std::array<double, 6>{100, 10, 0, 230, 0, -10};
  std::optional<double> nodata;
  double scale = 1.0, offset = 0.0;
  std::string srs = "EPSG:32611";
  std::string unit;
  int bands = 1;
  std::vector<std::uint8_t> alpha;  ///< A second band.
  std::vector<std::string> creation;
  std::string name = "/vsimem/made.tif";
};

std::string write(const Made& made) {
  GDALAllRegister();
  char** creation = nullptr;
  for (const std::string& option : made.creation) {
    creation = CSLAddString(creation, option.c_str());
  }
  const int bands = made.alpha.empty() ? made.bands : 2;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDatasetUniquePtr data(
      driver->Create(made.name.c_str(), made.columns, made.rows, bands, made.type, creation));
  CSLDestroy(creation);
  if (made.geotransform) {
    auto t = *made.geotransform;
    data->SetGeoTransform(t.data());
  }
  if (!made.srs.empty()) {
    OGRSpatialReference srs;
    srs.SetFromUserInput(made.srs.c_str());
    data->SetSpatialRef(&srs);
  }
  GDALRasterBand* band = data->GetRasterBand(1);
  if (made.nodata) band->SetNoDataValue(*made.nodata);
  if (made.scale != 1.0) band->SetScale(made.scale);
  if (made.offset != 0.0) band->SetOffset(made.offset);
  if (!made.unit.empty()) band->SetUnitType(made.unit.c_str());
  auto values = made.values;
  EXPECT_EQ(band->RasterIO(GF_Write, 0, 0, made.columns, made.rows, values.data(), made.columns,
                           made.rows, GDT_Float64, 0, 0, nullptr),
            CE_None);
  if (!made.alpha.empty()) {
    auto alpha = made.alpha;
    data->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
    EXPECT_EQ(
        data->GetRasterBand(2)->RasterIO(GF_Write, 0, 0, made.columns, made.rows, alpha.data(),
                                         made.columns, made.rows, GDT_Byte, 0, 0, nullptr),
        CE_None);
  }
  return made.name;
}

/// 3 x 2 samples; the file's rows are 1 2 3 (north) and 4 5 6 (south).
Made small() {
  Made made;
  made.columns = 3;
  made.rows = 2;
  made.values = {1, 2, 3, 4, 5, 6};
  return made;
}

RasterSource open(const Made& made, const SourceOptions& options = {}) {
  return RasterSource::open({write(made)}, options);
}

/// All heights, row 0 in the south; NaN where void.
std::vector<double> heights_of(const RasterSource& source) {
  const auto n = static_cast<std::size_t>(source.width() * source.height());
  std::vector<HeightBits> bits(n);
  std::vector<std::uint8_t> valid(n);
  source.read(0, 0, source.width(), source.height(), bits, valid);
  std::vector<double> heights;
  for (std::size_t i = 0; i < n; ++i) {
    heights.push_back(valid[i] ? source.frame().heights.height(bits[i])
                               : std::numeric_limits<double>::quiet_NaN());
    EXPECT_TRUE(valid[i] || bits[i] == 0);
  }
  return heights;
}

using Heights = std::vector<double>;

/// Equal, with NaN equal to itself.
void expect_heights(const RasterSource& source, const Heights& expected) {
  const Heights found = heights_of(source);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(found[i])) << i;
    } else {
      EXPECT_EQ(found[i], expected[i]) << i;
    }
  }
}

constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();

template <class Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "no error was thrown";
  return Error(ErrorCode::internal, "none");
}

Error open_error(const std::vector<std::string>& paths, std::stop_token stop = {}) {
  return error_of([&] { std::ignore = RasterSource::open(paths, {}, stop); });
}

void expect_refused(const Made& made, const std::string& word, const SourceOptions& options = {}) {
  const Error e = error_of([&] { open(made, options); });
  EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
  EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  EXPECT_EQ(e.context(), made.name);
}

// ---------------------------------------------------------------------------------------------------
// Place.

TEST(RasterSource, PutsSamplesAtPixelCentresWithRowsFromTheSouth) {
  const RasterSource source = open(small());
  EXPECT_EQ(source.width(), 3);
  EXPECT_EQ(source.height(), 2);
  EXPECT_EQ(source.frame().map, (AffineMap{105, 215, 10, 10}));
  expect_heights(source, {4, 5, 6, 1, 2, 3});
  EXPECT_EQ(source.valid_samples(), 6U);
  EXPECT_EQ(source.void_samples(), 0U);
  EXPECT_EQ(source.frame().horizontal_unit, "metre");
  EXPECT_FALSE(source.frame().geographic);
  EXPECT_EQ(source.frame().min_height, 1);
  EXPECT_EQ(source.frame().max_height, 6);
}

TEST(RasterSource, ReadsSouthUpRasters) {
  Made made = small();
  made.geotransform = {100, 10, 0, 210, 0, 10};
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().map, (AffineMap{105, 215, 10, 10}));
  expect_heights(source, {1, 2, 3, 4, 5, 6});
}

TEST(RasterSource, ReadsRastersWhoseColumnsGoWest) {
  Made made = small();
  made.geotransform = {130, -10, 0, 230, 0, -10};
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().map, (AffineMap{105, 215, 10, 10}));
  expect_heights(source, {6, 5, 4, 3, 2, 1});
}

TEST(RasterSource, PutsSamplesOfPixelIsPointFilesOnTheirTiepoints) {
  // With the shift of half a pixel switched off the tiepoint is written as given: (100, 230) is the
  // place of the first sample.
  CPLSetThreadLocalConfigOption("GTIFF_POINT_GEO_IGNORE", "YES");
  Made made = small();
  GDALAllRegister();
  write(made);
  {
    GDALDatasetUniquePtr data(GDALDataset::Open(made.name.c_str(), GDAL_OF_UPDATE));
    data->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
    auto t = *made.geotransform;
    data->SetGeoTransform(t.data());
  }
  CPLSetThreadLocalConfigOption("GTIFF_POINT_GEO_IGNORE", nullptr);
  const RasterSource source = RasterSource::open({made.name}, {});
  EXPECT_EQ(source.frame().map, (AffineMap{100, 220, 10, 10}));
}

TEST(RasterSource, UsesPixelsWhereThereIsNoGeotransform) {
  Made made = small();
  made.geotransform.reset();
  made.srs = "";
  const RasterSource source = open(made);
  EXPECT_EQ(source.frame().map, (AffineMap{0, 0, 1, 1}));
  EXPECT_EQ(source.frame().crs_wkt, "");
  EXPECT_EQ(source.frame().horizontal_unit, "unknown");
}

TEST(RasterSource, CropsToTheSamplesInsideClosedBounds) {
  SourceOptions options;
  options.bbox = {115, 215, 1000, 1000};
  const RasterSource source = open(small(), options);
  EXPECT_EQ(source.frame().map, (AffineMap{115, 215, 10, 10}));
  expect_heights(source, {5, 6, 2, 3});
  EXPECT_EQ(source.frame().min_height, 2);
}

TEST(RasterSource, RefusesBoundsWithoutASample) {
  SourceOptions options;
  options.bbox = {106, 0, 114, 1000};
  expect_refused(small(), "no sample lies in the bounds", options);
  options.bbox = {200, 0, 100, 1000};
  expect_refused(small(), "at most its maximum", options);
}

TEST(RasterSource, RefusesRotatedRasters) {
  Made made = small();
  made.geotransform = {100, 10, 1, 230, 1, -10};
  expect_refused(made, "rotated or sheared");
}

TEST(RasterSource, RefusesOneRowOrColumnAsCollinear) {
  Made made = small();
  made.columns = 6;
  made.rows = 1;
  expect_refused(made, "collinear");
  made.columns = 1;
  made.rows = 6;
  expect_refused(made, "collinear");
}

TEST(RasterSource, RefusesAnExtentBeyondTheGrid) {
  GDALAllRegister();
  const std::string vrt = R"(<VRTDataset rasterXSize="1073741826" rasterYSize="2">
    <GeoTransform>0, 1, 0, 2, 0, -1</GeoTransform>
    <VRTRasterBand dataType="Byte" band="1"/></VRTDataset>)";
  const Error e = open_error({vrt});
  EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
  EXPECT_NE(e.message().find("2^30"), std::string::npos) << e.what();
}

// ---------------------------------------------------------------------------------------------------
// Files that are no terrain.

TEST(RasterSource, SaysThatAFileDoesNotExist) {
  const Error e = open_error({"/nowhere/dem.tif"});
  EXPECT_EQ(e.code(), ErrorCode::not_found);
  EXPECT_EQ(e.context(), "/nowhere/dem.tif");
}

TEST(RasterSource, SaysThatAFileIsNoRaster) {
  const std::string path = "/vsimem/letter.doc";
  VSIFCloseL(VSIFileFromMemBuffer(path.c_str(),
                                  reinterpret_cast<GByte*>(VSIStrdup("Dear Sir, ...")), 13, TRUE));
  const Error e = open_error({path});
  EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
  EXPECT_NE(e.message().find("not a raster"), std::string::npos) << e.what();
  EXPECT_NE(e.message().find(".xyz"), std::string::npos) << e.what();
}

TEST(RasterSource, RefusesSeveralBandsAndComplexNumbers) {
  Made made = small();
  made.bands = 3;
  expect_refused(made, "has 3 bands");
  made = small();
  made.type = GDT_CFloat32;
  expect_refused(made, "complex");
}

TEST(RasterSource, NamesARasterInsideOfAFileThatHoldsSeveral) {
  const std::string source = write(small()), path = "/vsimem/several.gpkg";
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (driver == nullptr) GTEST_SKIP() << "GDAL was built without GeoPackage";
  GDALDatasetUniquePtr data(GDALDataset::Open(source.c_str()));
  for (const char* table : {"RASTER_TABLE=one", "RASTER_TABLE=two"}) {
    const char* options[] = {table, "APPEND_SUBDATASET=YES", nullptr};
    GDALClose(driver->CreateCopy(path.c_str(), data.get(), FALSE, const_cast<char**>(options),
                                 nullptr, nullptr));
  }
  const Error e = open_error({path});
  EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
  EXPECT_NE(e.message().find("several rasters; name one, such as GPKG:"), std::string::npos)
      << e.what();
}

TEST(RasterSource, ReportsATruncatedFileInsteadOfHeights) {
  Made made = small();
  made.columns = made.rows = 64;
  made.values.assign(64 * 64, 0);
  for (std::size_t i = 0; i < made.values.size(); ++i) {
    made.values[i] = static_cast<double>(i % 1777);
  }
  made.creation = {"COMPRESS=DEFLATE"};
  write(made);
  vsi_l_offset bytes = 0;
  VSIGetMemFileBuffer(made.name.c_str(), &bytes, FALSE);
  VSILFILE* file = VSIFOpenL(made.name.c_str(), "r+b");
  VSIFTruncateL(file, bytes - 500);
  VSIFCloseL(file);
  const Error e = open_error({made.name});
  EXPECT_TRUE(e.code() == ErrorCode::io_error || e.code() == ErrorCode::invalid_argument)
      << e.what();
}

TEST(RasterSource, ReportsAMosaicVrtWhoseTileIsMissing) {
  const std::string vrt = R"(<VRTDataset rasterXSize="4" rasterYSize="4">
    <GeoTransform>0, 1, 0, 4, 0, -1</GeoTransform>
    <VRTRasterBand dataType="Int16" band="1"><SimpleSource>
    <SourceFilename relativeToVRT="0">/nowhere/tile.tif</SourceFilename><SourceBand>1</SourceBand>
    <SourceProperties RasterXSize="4" RasterYSize="4" DataType="Int16" BlockXSize="4" BlockYSize="4"/>
    <SrcRect xOff="0" yOff="0" xSize="4" ySize="4"/><DstRect xOff="0" yOff="0" xSize="4" ySize="4"/>
    </SimpleSource></VRTRasterBand></VRTDataset>)";
  const Error e = open_error({vrt});
  EXPECT_EQ(e.code(), ErrorCode::io_error);
  EXPECT_NE(e.message().find("/nowhere/tile.tif"), std::string::npos) << e.what();
}

// ---------------------------------------------------------------------------------------------------
// Voids.

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

// ---------------------------------------------------------------------------------------------------
// Heights.

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

// ---------------------------------------------------------------------------------------------------
// Windows and mosaics.

TEST(RasterSource, ReadsAnyWindowAsPartOfTheWhole) {
  Made made;
  made.columns = 70;
  made.rows = 50;
  for (int i = 0; i < made.columns * made.rows; ++i) {
    made.values.push_back(i % 997);
  }
  made.nodata = 13;
  made.creation = {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=32"};
  const RasterSource source = open(made);
  const Heights whole = heights_of(source);
  for (std::int64_t x : {0, 1, 15, 16, 60}) {
    for (std::int64_t y : {0, 17, 31, 40}) {
      const std::int64_t w = 10, h = 10;
      std::vector<HeightBits> bits(100);
      std::vector<std::uint8_t> valid(100);
      source.read(x, y, w, h, bits, valid);
      for (std::int64_t i = 0; i < 100; ++i) {
        const double expected = whole[static_cast<std::size_t>((y + i / w) * 70 + x + i % w)];
        ASSERT_EQ(valid[i] == 0, std::isnan(expected));
        if (valid[i]) {
          ASSERT_EQ(source.frame().heights.height(bits[i]), expected);
        }
      }
    }
  }
}

TEST(RasterSource, RefusesAWindowOutsideOfTheTerrain) {
  const RasterSource source = open(small());
  std::vector<HeightBits> bits(4);
  std::vector<std::uint8_t> valid(4);
  EXPECT_THROW(source.read(2, 0, 2, 2, bits, valid), Error);
  EXPECT_THROW(source.read(-1, 0, 2, 2, bits, valid), Error);
  EXPECT_THROW(source.read(0, 0, 1, 2, bits, valid), Error);
}

TEST(RasterSource, JoinsSeveralRastersOfOneGrid) {
  Made west = small(), east = small();
  west.name = "/vsimem/west.tif";
  east.name = "/vsimem/east.tif";
  east.geotransform = {120, 10, 0, 240, 0, -10};  // shares a column, one row further north
  east.values = {10, 20, 30, 40, -1, 60};
  east.nodata = -1;
  const RasterSource source = RasterSource::open({write(west), write(east)}, {});
  EXPECT_EQ(source.frame().map, (AffineMap{105, 215, 10, 10}));
  EXPECT_EQ(source.width(), 5);
  EXPECT_EQ(source.height(), 3);
  expect_heights(source, {4, 5, 6, kVoid, kVoid,  //
                          1, 2, 40, kVoid, 60,    //
                          kVoid, kVoid, 10, 20, 30});
  EXPECT_EQ(source.void_samples(), 5U);
  const RasterSource turned = RasterSource::open({east.name, west.name}, {});
  EXPECT_EQ(heights_of(turned)[7], 3) << "the last one with a height wins";
}

TEST(RasterSource, JoinsMoreFilesThanItKeepsOpen) {
  std::vector<std::string> paths;
  Heights expected;
  for (int i = 0; i < 100; ++i) {
    Made made = small();
    made.name = "/vsimem/column_" + std::to_string(i) + ".tif";
    made.columns = 1;
    made.rows = 2;
    made.values = {double(i), double(1000 + i)};
    made.geotransform = {100.0 + 10 * i, 10, 0, 230, 0, -10};
    paths.push_back(write(made));
    expected.push_back(1000 + i);
  }
  for (int i = 0; i < 100; ++i) {
    expected.push_back(i);
  }
  const RasterSource source = RasterSource::open(paths, {});
  expect_heights(source, expected);
  expect_heights(source, expected);
  expect_heights(source.duplicate(), expected);
}

/// As many descriptors as this, for as long as it lives.
class FewDescriptors {
 public:
  explicit FewDescriptors(rlim_t count) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = count;
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~FewDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

TEST(RasterSource, SharesTheDescriptorsOfTheProcessWithItsDuplicates) {
  constexpr int kFiles = 40;
  const oracle::ScratchFolder folder;
  std::vector<std::string> paths;
  Heights expected;
  for (int i = 0; i < kFiles; ++i) {
    Made made = small();
    made.name = folder.file(std::to_string(i) + ".tif");
    made.columns = made.rows = 2;
    made.values = {double(i), double(i), double(i), double(i)};
    made.geotransform = {100.0 + 20 * i, 10, 0, 230, 0, -10};
    paths.push_back(write(made));
  }
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < 2 * kFiles; ++i) {
      expected.push_back(i / 2);
    }
  }
  const FewDescriptors limit(128);
  const RasterSource source = RasterSource::open(paths, {});
  std::vector<RasterSource> copies;
  for (int i = 0; i < 16; ++i) {
    copies.push_back(source.duplicate());
  }
  for (const RasterSource& copy : copies) {
    expect_heights(copy, expected);
  }
}

TEST(RasterSource, RefusesToJoinRastersOfDifferentGrids) {
  Made first = small(), second = small();
  first.name = "/vsimem/first.tif";
  second.name = "/vsimem/second.tif";
  write(first);
  const auto refused = [&](const std::string& word) {
    const Error e = open_error({first.name, write(second)});
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(e.context(), second.name);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  };
  second.geotransform = {103, 10, 0, 230, 0, -10};
  refused("between those of the first");
  second.geotransform = {100, 10.1, 0, 230, 0, -10};
  refused("pixel size");
  second = small();
  second.name = "/vsimem/second.tif";
  second.type = GDT_Float32;
  refused("type");
  second.type = GDT_Int16;
  second.srs = "EPSG:32612";
  refused("CRS");
  second.geotransform.reset();
  refused("geotransform");
}

TEST(RasterSource, DuplicatesReadTheSame) {
  const RasterSource source = open(small());
  const RasterSource copy = source.duplicate();
  EXPECT_EQ(copy.valid_samples(), 6U);
  expect_heights(copy, heights_of(source));
}

TEST(RasterSource, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const std::string path = write(small());
  const Error e = open_error({path}, stop.get_token());
  EXPECT_EQ(e.code(), ErrorCode::cancelled);
}

TEST(RasterSource, ReportsItsProgressToTheEnd) {
  std::uint64_t last = 0, all = 0;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_GT(done, last);
    last = done;
    all = total;
  };
  std::ignore = RasterSource::open({write(small())}, {}, {}, progress);
  EXPECT_EQ(last, 6U);
  EXPECT_EQ(all, 6U);
}

// ---------------------------------------------------------------------------------------------------
// Real terrains.

std::string test_data(const std::string& name) {
  return (std::filesystem::path(PTIN_TEST_DATA) / name).string();
}

TEST(RasterSourceOnRealTerrain, ReadsTheTerrainsOfThisFolder) {
  const RasterSource mountains = RasterSource::open({test_data("mountains_257.tif")}, {});
  EXPECT_EQ(mountains.valid_samples(), 257U * 257U);
  EXPECT_EQ(mountains.frame().min_height, 633);
  EXPECT_EQ(mountains.frame().max_height, 1576);
  EXPECT_EQ(mountains.frame().map.step_x, 30);
  const RasterSource coast = RasterSource::open({test_data("coast_257.tif")}, {});
  EXPECT_EQ(coast.valid_samples(), 42642U);
  EXPECT_EQ(coast.void_samples(), 257U * 257U - 42642U);
  EXPECT_TRUE(coast.frame().geographic);
}

std::string shared_data(const std::string& name) {
  return (std::filesystem::path(PTIN_SHARED_DATA) / name).string();
}

#define PTIN_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here"

TEST(RasterSourceOnRealTerrain, ReadsAMosaicAsItsVrtAndAsItsFiles) {
  const std::string folder = shared_data("mosaic_northengland/");
  PTIN_SKIP_WITHOUT(folder);
  const RasterSource vrt = RasterSource::open({folder + "northengland.vrt"}, {});
  EXPECT_EQ(vrt.width(), 3601);
  EXPECT_EQ(vrt.height(), 2401);
  EXPECT_EQ(vrt.frame().min_height, -49);
  EXPECT_EQ(vrt.frame().max_height, 1059);
  EXPECT_TRUE(vrt.frame().geographic);
  EXPECT_EQ(vrt.frame().horizontal_unit, "degree");
  std::vector<std::string> files;
  for (const char* tile : {"n53w004", "n53w003", "n53w002", "n54w004", "n54w003", "n54w002"}) {
    files.push_back(folder + "srtm3_" + tile + ".tif");
  }
  const RasterSource joined = RasterSource::open(files, {});
  EXPECT_NEAR(joined.frame().map.origin_x, vrt.frame().map.origin_x, 1e-9);
  EXPECT_NEAR(joined.frame().map.origin_y, vrt.frame().map.origin_y, 1e-9);
  EXPECT_EQ(joined.valid_samples(), vrt.valid_samples());
  EXPECT_TRUE(heights_of(joined) == heights_of(vrt));
}

TEST(RasterSourceOnRealTerrain, KnowsWhatEachDeclares) {
  struct Expected {
    const char* name;
    std::uint64_t valid;
    double low, high;
    HeightType type;
    double quantum;
  };
  for (const Expected& e : {
           Expected{"srtm1_n48w125_olympic_3601.tif", 6483325, -13, 1095, HeightType::int32, 1},
           Expected{"srtm3_rainier_1201.tif", 1433368, 263, 4371, HeightType::int32, 1},
           Expected{"srtm3_n53e027_minsk_uint16.tif", 1442401, 142, 354, HeightType::int32, 1},
           Expected{"lidar_dtm1m_slovenia_564_146.tif", 1000000, 254.97, 325.05,
                    HeightType::float32, 0.01},
       }) {
    const std::string path = shared_data(e.name);
    PTIN_SKIP_WITHOUT(path);
    const RasterSource source = RasterSource::open({path}, {});
    EXPECT_EQ(source.valid_samples(), e.valid) << e.name;
    EXPECT_NEAR(source.frame().min_height, e.low, 1e-4) << e.name;
    EXPECT_NEAR(source.frame().max_height, e.high, 1e-4) << e.name;
    EXPECT_EQ(source.frame().heights.type, e.type) << e.name;
    EXPECT_EQ(source.frame().height_quantum, e.quantum) << e.name;
  }
}

TEST(RasterSourceOnRealTerrain, KeepsFloat64ThatWasFloat32) {
  const std::string path = shared_data("dtm5m_austria_alr_float64.tif");
  PTIN_SKIP_WITHOUT(path);
  const RasterSource source = RasterSource::open({path}, {});
  EXPECT_EQ(source.frame().heights.type, HeightType::float32);
  EXPECT_EQ(source.frame().height_rounding, 0);
  EXPECT_NEAR(static_cast<double>(source.valid_samples()) / (417 * 915), 0.694, 0.001);
}

}  // namespace
}  // namespace ptin
