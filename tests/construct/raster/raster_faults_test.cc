// SPDX-License-Identifier: GPL-3.0-or-later
//
// RasterSource: files that are no terrain.
#include <string>

#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "tests/construct/raster/raster_fixture.h"

namespace ptin {
namespace {

using namespace raster_fixture;

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
  EXPECT_NE(e.message().find("neither a raster"), std::string::npos) << e.what();
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

}  // namespace
}  // namespace ptin
