// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters that say what they hold in a rare way: signed bytes, nodata of the whole file, unusual
// geotransforms; each is built right, and `ptin verify --against` reads the same from it.
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gdal_priv.h>
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

/// -20 to 20, of either sign in every part of the raster.
int signed_height(int column, int row) { return (column * 7 + row * 13 + column * row) % 41 - 20; }

/// GDAL has the type since 3.7; before, it is a note on bytes that are read as 0 to 255.
RasterRecipe signed_bytes() {
  RasterRecipe recipe;
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 7, 0)
  recipe.type = "Int8";
  recipe.value = [](int x, int y) { return double{signed_height(x, y)}; };
#else
  recipe.type = "Byte";
  recipe.creation = {"PIXELTYPE=SIGNEDBYTE"};
  recipe.value = [](int x, int y) {
    return static_cast<double>((signed_height(x, y) + 256) % 256);
  };
#endif
  return recipe;
}

/// A VRT over `source` of 33 x 33 samples in one band of this type, with what else it says.
std::string vrt_text(const std::string& source, const std::string& type, const std::string& place,
                     const std::string& of_file, const std::string& of_band) {
  std::ostringstream text;
  text << R"(<VRTDataset rasterXSize="33" rasterYSize="33">)" << of_file << "<GeoTransform>"
       << place << R"(</GeoTransform><VRTRasterBand dataType=")" << type << R"(" band="1">)"
       << of_band << R"(<SimpleSource><SourceFilename relativeToVRT="1">)" << source
       << "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>";
  return text.str();
}

class RasterKinds : public ::testing::Test {
 protected:
  json built(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"build", folder_.file(name), "-o", store_, "--overwrite", "-q",
                                    "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return answer_of(all);
  }
  void expect_sound(const std::string& name) {
    const Outcome outcome = run_ptin({"verify", store_, "--against", folder_.file(name), "-q"});
    EXPECT_EQ(outcome.status, 0) << name << outcome.out << outcome.err;
  }
  void expect_refused(const std::string& name) {
    const auto before = folder_.names();
    const Outcome outcome = run_ptin({"build", folder_.file(name), "-o", store_, "-q"});
    EXPECT_EQ(outcome.status, 2) << name << outcome.err;
    EXPECT_EQ(testing::lines_in(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(folder_.names(), before);
  }
  TestFolder folder_;
  std::string store_ = folder_.file("t.ptin");
};

TEST_F(RasterKinds, SignedBytesAreBelowZeroToo) {
  make_raster(folder_.file("s.tif"), signed_bytes());
  EXPECT_EQ(built("s.tif").at("void_samples"), 0);
  const json info = answer_of({"info", store_, "--json"});
  EXPECT_EQ(info.at("heights").at("min"), -20.0);
  EXPECT_EQ(info.at("heights").at("max"), 20.0);
  expect_sound("s.tif");
}

// GDAL's own mask takes -9 for a value that no byte has.
TEST_F(RasterKinds, SignedBytesHaveNodataBelowZero) {
  RasterRecipe recipe = signed_bytes();
  recipe.nodata = -9.0;
  make_raster(folder_.file("s.tif"), recipe);
  int voids = 0;
  for (int y = 0; y < 33; ++y) {
    for (int x = 0; x < 33; ++x) voids += signed_height(x, y) == -9 ? 1 : 0;
  }
  ASSERT_GT(voids, 10);
  EXPECT_EQ(built("s.tif").at("void_samples"), voids);
  expect_sound("s.tif");
}

TEST_F(RasterKinds, SignedBytesTakeAnotherNodataInThePlaceOfTheirOwn) {
  RasterRecipe recipe = signed_bytes();
  recipe.nodata = -9.0;
  make_raster(folder_.file("s.tif"), recipe);
  EXPECT_GT(built("s.tif", {"--nodata", "5"}).at("void_samples"), 0);
  expect_sound("s.tif");
}

/// Hills above 30, with a square of 36 samples of 5 and one of 16 samples of 7.
double two_squares(int x, int y) {
  if (x >= 5 && x < 11 && y >= 8 && y < 14) return 5.0;
  if (x >= 20 && x < 24 && y >= 20 && y < 24) return 7.0;
  return std::round(testing::hills(x, y));
}

TEST_F(RasterKinds, NodataOfTheWholeFileIsVoid) {
  RasterRecipe recipe;
  recipe.value = two_squares;
  make_raster(folder_.file("r.tif"), recipe);
  write_file(folder_.file("r.vrt"),
             vrt_text("r.tif", "Int16", "500000, 30, 0, 4000000, 0, -30",
                      R"(<Metadata><MDI key="NODATA_VALUES">5</MDI></Metadata>)", ""));
  EXPECT_EQ(built("r.vrt").at("void_samples"), 36);
  EXPECT_EQ(answer_of({"info", store_, "--json"}).at("heights").at("min"), 7.0);
  expect_sound("r.vrt");
  EXPECT_EQ(built("r.vrt", {"--nodata", "7"}).at("void_samples"), 16) << "instead of the file's";
  EXPECT_EQ(answer_of({"info", store_, "--json"}).at("heights").at("min"), 5.0);
  expect_sound("r.vrt");
}

// (0, 1, 0, 0, 0, 1) is what GDAL answers where there is none, and here it is meant.
TEST_F(RasterKinds, GeotransformThatLooksLikeNoneIsOne) {
  make_raster(folder_.file("r.tif"), {});
  write_file(folder_.file("r.vrt"), vrt_text("r.tif", "Float32", "0, 1, 0, 0, 0, 1", "", ""));
  built("r.vrt");
  expect_sound("r.vrt");
}

// What the reckoning of a geotransform left behind moves no sample by a hundredth of a pixel.
TEST_F(RasterKinds, GeotransformWithATraceOfSkewIsStraight) {
  make_raster(folder_.file("r.tif"), {});
  write_file(folder_.file("r.vrt"),
             vrt_text("r.tif", "Float32", "500000, 30, 0.000003, 4000000, -0.000003, -30", "", ""));
  built("r.vrt");
  expect_sound("r.vrt");
}

TEST_F(RasterKinds, ScaleThatMakesHeightsInfiniteIsRefused) {
  make_raster(folder_.file("r.tif"), {});
  write_file(folder_.file("r.vrt"),
             vrt_text("r.tif", "Int16", "0, 1, 0, 100, 0, -1", "", "<Scale>1e308</Scale>"));
  expect_refused("r.vrt");
}

// At 500 000 the next double is 6e-11 away: pixels of 1e-9 would lie where no multiple of them is.
TEST_F(RasterKinds, PixelsFinerThanTheirCoordinatesAreRefused) {
  make_raster(folder_.file("r.tif"), {});
  write_file(folder_.file("r.vrt"),
             vrt_text("r.tif", "Float32", "500000, 1e-10, 0, 500000, 0, -1e-10", "", ""));
  expect_refused("r.vrt");
}

}  // namespace
}  // namespace ptin::tools
