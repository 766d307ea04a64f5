// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples of a VRT that none of its sources covers are void, whatever GDAL hands out for them.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::make_raster;
using testing::Outcome;
using testing::RasterRecipe;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

/// Tiles of 4 x 4 samples, and VRTs of 12 x 4 over them.
class VrtCoverage : public ::testing::Test {
 protected:
  void make_tile(const std::string& name, const std::string& type, double low) {
    RasterRecipe recipe;
    recipe.width = recipe.height = 4;
    recipe.type = type;
    recipe.value = [low](int x, int y) { return low + 3 * x + y * y; };
    make_raster(folder_.file(name), recipe);
  }
  /// One of the elements by which a VRT names a source: this file, `columns` of it, at this column.
  static std::string source(const std::string& name, int at, const std::string& more = "",
                            int columns = 4) {
    const std::string kind = more.empty() ? "SimpleSource" : "ComplexSource";
    const std::string size = "\" xSize=\"" + std::to_string(columns) + "\" ySize=\"4\"/>";
    return "<" + kind + R"(><SourceFilename relativeToVRT="1">)" + name +
           "</SourceFilename><SourceBand>1</SourceBand><SrcRect xOff=\"0\" yOff=\"0" + size +
           "<DstRect yOff=\"0\" xOff=\"" + std::to_string(at) + size + more + "</" + kind + ">";
  }
  void make_vrt(const std::string& name, const std::string& type, const std::string& of_band,
                const std::string& more_bands = "") {
    write_file(folder_.file(name),
               R"(<VRTDataset rasterXSize="12" rasterYSize="4"><SRS>EPSG:32611</SRS>)"
               "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>"
               R"(<VRTRasterBand dataType=")" +
                   type + R"(" band="1">)" + of_band + "</VRTRasterBand>" + more_bands +
                   "</VRTDataset>");
  }
  /// A VRT that warps a file to the same places, on a grid of so many columns.
  void make_warp(const std::string& type, const std::string& name, int columns) {
    const std::string place = "500000,30,0,4000000,0,-30";
    write_file(folder_.file("s.vrt"),
               R"(<VRTDataset subClass="VRTWarpedDataset" rasterYSize="4" rasterXSize=")" +
                   std::to_string(columns) + R"("><SRS>EPSG:32611</SRS><GeoTransform>)" + place +
                   R"(</GeoTransform><VRTRasterBand dataType=")" + type +
                   R"(" band="1" subClass="VRTWarpedRasterBand"></VRTRasterBand>)"
                   "<BlockXSize>8</BlockXSize><BlockYSize>4</BlockYSize><GDALWarpOptions>"
                   "<WorkingDataType>" +
                   type +
                   R"(</WorkingDataType><Option name="INIT_DEST">0</Option>)"
                   R"(<SourceDataset relativeToVRT="1">)" +
                   name + "</SourceDataset><Transformer><GenImgProjTransformer><SrcGeoTransform>" +
                   place + "</SrcGeoTransform><DstGeoTransform>" + place +
                   "</DstGeoTransform></GenImgProjTransformer></Transformer>"
                   R"(<BandList><BandMapping src="1" dst="1"/></BandList></GDALWarpOptions>)"
                   "</VRTDataset>");
  }
  void expect_void(const std::string& name, int count, const std::vector<std::string>& more = {}) {
    SCOPED_TRACE(name);
    std::vector<std::string> all = {"build", folder_.file(name), "-o", store_, "--overwrite", "-q",
                                    "--json"};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(answer_of(all).at("void_samples"), count);
    const Outcome sound = run_ptin({"verify", store_, "--against", folder_.file(name), "-q"});
    EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
  }
  TestFolder folder_;
  std::string store_ = folder_.file("t.ptin");
};

TEST_F(VrtCoverage, LeavesGapsBetweenSourcesOfEveryTypeVoid) {
  for (const std::string type : {"Byte", "Int32", "UInt32", "Float32"}) {
    SCOPED_TRACE(type);
    make_tile("a.tif", type, 0);
    make_tile("b.tif", type, 40);
    make_vrt("s.vrt", type, source("a.tif", 0) + source("b.tif", 8));
    expect_void("s.vrt", 16);
    make_vrt("whole.vrt", type, source("a.tif", 0) + source("b.tif", 4) + source("a.tif", 8));
    expect_void("whole.vrt", 0);
  }
}

TEST_F(VrtCoverage, LeavesGapsVoidBesideAnotherNodataValue) {
  make_tile("a.tif", "Int16", 0);
  make_vrt("s.vrt", "Int16", "<NoDataValue>-9999</NoDataValue>" + source("a.tif", 2));
  expect_void("s.vrt", 32);
  expect_void("s.vrt", 33, {"--nodata", "0"});  // one height of the tile is 0
}

TEST_F(VrtCoverage, LeavesWhatSourcesDoNotHaveVoid) {
  make_tile("a.tif", "Float32", 0);
  make_vrt("s.vrt", "Float32", source("a.tif", 0, "<NODATA>0</NODATA>", 4));
  expect_void("s.vrt", 33);
  make_vrt(
      "hidden.vrt", "Float32",
      "<NoDataValue>-1</NoDataValue><HideNoDataValue>1</HideNoDataValue>" + source("a.tif", 4));
  expect_void("hidden.vrt", 32);
}

TEST_F(VrtCoverage, LooksThroughVrtsInVrts) {
  for (const std::string type : {"Int16", "Float64"}) {
    SCOPED_TRACE(type);
    make_tile("a.tif", type, 1);
    make_tile("b.tif", type, 40);
    make_vrt("left.vrt", type, source("a.tif", 0));
    make_vrt("right.vrt", type, source("b.tif", 8));
    make_vrt("both.vrt", type, source("left.vrt", 0, "", 12) + source("right.vrt", 0, "", 12));
    expect_void("both.vrt", 16);  // and the right one does not hide the left one
    EXPECT_EQ(answer_of({"info", store_, "--json"}).at("heights").at("min"), 1.0);
    make_vrt("third.vrt", type, source("both.vrt", 0, "", 12));
    expect_void("third.vrt", 16);
    make_vrt("scaled.vrt", type,
             source("both.vrt", 0, "<ScaleOffset>1</ScaleOffset><ScaleRatio>2</ScaleRatio>", 12));
    expect_void("scaled.vrt", 16);
  }
}

TEST_F(VrtCoverage, FindsFilesInTheFolderOfTheVrtThatNamesThem) {
  std::filesystem::create_directory(folder_.file("inner"));
  make_tile("inner/a.tif", "Int16", 1);
  make_vrt("inner/s.vrt", "Int16", source("a.tif", 0) + source("a.tif", 8));
  make_vrt("s.vrt", "Int16", source("inner/s.vrt", 0, "", 12));
  expect_void("s.vrt", 16);
}

TEST_F(VrtCoverage, EndsWhereAVrtNamesItself) {
  make_tile("a.tif", "Int16", 1);
  make_vrt("s.vrt", "Int16", source("a.tif", 0) + source("s.vrt", 4));
  const Outcome built = run_ptin({"build", folder_.file("s.vrt"), "-o", store_, "-q"});
  EXPECT_TRUE(built.status == 0 || built.status == 6) << built.err;
}

TEST_F(VrtCoverage, LeavesAlphaAndMasksAsTheyAre) {
  make_tile("a.tif", "Int16", 1);
  make_tile("alpha.tif", "Byte", 0);
  make_vrt("s.vrt", "Int16", source("a.tif", 0) + source("a.tif", 8),
           R"(<VRTRasterBand dataType="Byte" band="2"><ColorInterp>Alpha</ColorInterp>)" +
               source("alpha.tif", 0) + "</VRTRasterBand>");
  expect_void("s.vrt", 33);
  make_vrt("mask.vrt", "Int16", source("a.tif", 0) + source("a.tif", 8),
           R"(<MaskBand><VRTRasterBand dataType="Byte">)" + source("alpha.tif", 0) +
               "</VRTRasterBand></MaskBand>");
  expect_void("mask.vrt", 33);
}

TEST_F(VrtCoverage, LeavesGapsOfAVrtThatIsWarpedVoid) {
  make_tile("a.tif", "Float32", 1);
  make_vrt("gap.vrt", "Float32", source("a.tif", 0) + source("a.tif", 8));
  make_warp("Float32", "gap.vrt", 12);
  expect_void("s.vrt", 16);
}

TEST_F(VrtCoverage, LeavesWhatAWarpDoesNotCoverVoid) {
  for (const std::string type : {"Int16", "Float32"}) {
    SCOPED_TRACE(type);
    make_tile("a.tif", type, 1);
    make_warp(type, "a.tif", 8);
    expect_void("s.vrt", 16);
  }
}

}  // namespace
}  // namespace ptin::tools
