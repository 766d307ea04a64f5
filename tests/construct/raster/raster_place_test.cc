// SPDX-License-Identifier: GPL-3.0-or-later
//
// RasterSource: where the samples of a raster stand, and which part of it is taken.
#include <string>

#include <cpl_conv.h>
#include <gdal_priv.h>

#include "engine/construct/grid/source_options.h"
#include "tests/construct/raster/raster_fixture.h"

namespace ptin {
namespace {

using namespace raster_fixture;

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

}  // namespace
}  // namespace ptin
