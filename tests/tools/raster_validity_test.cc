// SPDX-License-Identifier: GPL-3.0-or-later
//
// Masks of samples of a raster, beside samples of every type: alpha bands, masks, nodata values
// in other digits than the type has. `ptin verify --against` reads the same by code of its own.
#include <cfloat>
#include <limits>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::hills;
using testing::make_raster;
using testing::Outcome;
using testing::RasterRecipe;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class RasterValidity : public ::testing::Test {
 protected:
  /// Hills in a raster of this type, and `odd` at (5, 5).
  void make_base(const std::string& type, double odd, std::vector<std::string> creation = {}) {
    RasterRecipe recipe;
    recipe.type = type;
    recipe.creation = std::move(creation);
    recipe.value = [odd](int x, int y) { return x == 5 && y == 5 ? odd : 50 + hills(x, y); };
    make_raster(folder_.file("base.tif"), recipe);
    recipe.type = "Byte";
    recipe.creation.clear();
    recipe.value = [](int x, int y) { return x == 5 && y == 5 ? 0.0 : 1.0; };
    make_raster(folder_.file("alpha.tif"), recipe);
  }
  void make_vrt(const std::string& type, const std::string& of_band, const std::string& more) {
    write_file(folder_.file("s.vrt"),
               R"(<VRTDataset rasterXSize="33" rasterYSize="33"><SRS>EPSG:32611</SRS>)"
               "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>"
               R"(<VRTRasterBand dataType=")" +
                   type + R"(" band="1">)" + of_band + source("base.tif") + "</VRTRasterBand>" +
                   more + "</VRTDataset>");
  }
  static std::string source(const std::string& name) {
    return R"(<SimpleSource><SourceFilename relativeToVRT="1">)" + name +
           "</SourceFilename><SourceBand>1</SourceBand></SimpleSource>";
  }
  json built(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"build", folder_.file(name), "-o", store_, "--overwrite", "-q",
                                    "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return answer_of(all);
  }
  void expect_one_void(const std::string& name, const std::vector<std::string>& more = {}) {
    EXPECT_EQ(built(name, more).at("void_samples"), 1);
    const Outcome sound = run_ptin({"verify", store_, "--against", folder_.file(name), "-q"});
    EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
  }
  TestFolder folder_;
  std::string store_ = folder_.file("t.ptin");
};

TEST_F(RasterValidity, AlphaMasksSamplesOfEveryType) {
  for (const std::string type :
       {"Byte", "UInt16", "Int16", "UInt32", "Int32", "Float32", "Float64", "Int64", "UInt64"}) {
    SCOPED_TRACE(type);
    make_base(type, 0);
    for (const std::string alpha : {"Byte", type.c_str()}) {
      make_vrt(type, "",
               R"(<VRTRasterBand dataType=")" + alpha +
                   R"(" band="2"><ColorInterp>Alpha</ColorInterp>)" + source("alpha.tif") +
                   "</VRTRasterBand>");
      expect_one_void("s.vrt");
    }
  }
}

TEST_F(RasterValidity, AlphaMasksBesideANodataValue) {
  make_base("Float32", 0);
  make_vrt("Float32", "<NoDataValue>-9999</NoDataValue>",
           R"(<VRTRasterBand dataType="Float32" band="2"><ColorInterp>Alpha</ColorInterp>)" +
               source("alpha.tif") + "</VRTRasterBand>");
  expect_one_void("s.vrt");
}

TEST_F(RasterValidity, AlphaMayComeFirst) {
  make_base("Float32", 0);
  write_file(folder_.file("s.vrt"),
             R"(<VRTDataset rasterXSize="33" rasterYSize="33"><SRS>EPSG:32611</SRS>)"
             "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>"
             R"(<VRTRasterBand dataType="Float32" band="1"><ColorInterp>Alpha</ColorInterp>)" +
                 source("alpha.tif") +
                 R"(</VRTRasterBand><VRTRasterBand dataType="Float32" band="2">)" +
                 source("base.tif") + "</VRTRasterBand></VRTDataset>");
  expect_one_void("s.vrt");
}

TEST_F(RasterValidity, NodataIsComparedAsTheTypeHoldsItWhoeverDeclaresIt) {
  const double lowest = -double{FLT_MAX};
  for (const auto& [odd, written] : std::vector<std::pair<double, std::string>>{
           {-9999.9, "-9999.9"}, {lowest, "-3.4e38"}, {lowest, "-3.4028234663852886e+38"}}) {
    make_base("Float32", odd);
    for (const std::string scale : {"", "<Scale>0.25</Scale><Offset>3</Offset>"}) {
      for (const std::string type : {"Float32", "Float64"}) {
        SCOPED_TRACE(written + scale + type);
        make_vrt(type, scale + "<NoDataValue>" + written + "</NoDataValue>", "");
        expect_one_void("s.vrt");
        make_vrt(type, scale, "");
        expect_one_void("s.vrt", {"--nodata", written});
      }
    }
  }
}

TEST_F(RasterValidity, InfiniteNodataIsThatAlone) {
  for (const std::string type : {"Float32", "Float64"}) {
    make_base(type, std::numeric_limits<double>::infinity());
    expect_one_void("base.tif", {"--nodata", "inf"});
  }
}

TEST_F(RasterValidity, NodataOfHalfFloatsIsComparedAsTheyHoldIt) {
  make_base("Float32", -9999, {"NBITS=16"});
  expect_one_void("base.tif", {"--nodata", "-9999"});
}

TEST_F(RasterValidity, TheLargestFloatsAreNoHeightsAndTheMessageNamesTheWayOut) {
  for (const double odd : {double{FLT_MAX}, -double{FLT_MAX}}) {
    for (const std::string type : {"Float32", "Float64"}) {
      make_base(type, odd);
      const Outcome refused =
          run_ptin({"build", folder_.file("base.tif"), "-o", store_, "-q", "--overwrite"});
      EXPECT_EQ(refused.status, 2);
      EXPECT_NE(refused.err.find("column 5, row 5"), std::string::npos) << refused.err;
      const std::size_t option = refused.err.find("--nodata ");
      ASSERT_NE(option, std::string::npos) << refused.err;
      const std::string value = refused.err.substr(option + 9, refused.err.find('\n') - option - 9);
      expect_one_void("base.tif", {"--nodata", value});
    }
  }
}

TEST_F(RasterValidity, UndeclaredNodataIsToldWithCountAndPlace) {
  make_base("Int16", -9999);
  const json told = built("base.tif").at("warnings");
  ASSERT_EQ(told.size(), 1U) << told;
  EXPECT_EQ(told[0].at("kind"), "undeclared_nodata");
  EXPECT_EQ(told[0].at("count"), 1);
  EXPECT_EQ(told[0].at("file"), folder_.file("base.tif"));
  EXPECT_NE(told[0].at("message").get<std::string>().find("x 500165, y 3999835"), std::string::npos)
      << told;
  expect_one_void("base.tif", {"--nodata", "-9999"});
  EXPECT_EQ(built("base.tif", {"--nodata", "-9999"}).at("warnings"), json::array());
}

TEST_F(RasterValidity, WarningsAreThoseOfADryRunAndOfAnyNumberOfThreads) {
  make_base("Int16", -9999);
  const json one = built("base.tif", {"--threads", "1"}).at("warnings");
  EXPECT_EQ(built("base.tif", {"--threads", "4"}).at("warnings"), one);
  EXPECT_EQ(built("base.tif", {"--dry-run"}).at("warnings"), one);
  const Outcome words = run_ptin({"build", folder_.file("base.tif"), "-o", store_, "--overwrite"});
  EXPECT_NE(
      words.err.find("ptin: warning: " + folder_.file("base.tif") + ": the stored value -9999"),
      std::string::npos)
      << words.err;
}

}  // namespace
}  // namespace ptin::tools
