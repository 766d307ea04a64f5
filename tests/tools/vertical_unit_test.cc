// SPDX-License-Identifier: GPL-3.0-or-later
//
// In what unit heights are, as rasters and meshes declare it: what a build keeps of that, and what
// a line of sight makes of it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::TestFolder;
using testing::write_file;

/// The line between two ends 39 km apart and 1000 units above flat ground, whose band says `unit`.
json sight_over_flat_ground(const std::string& unit, int epsg = 32611) {
  const TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.width = 40;
  recipe.height = 5;
  recipe.pixel = 1000;
  recipe.value = [](int, int) { return 0.0; };
  recipe.unit = unit;
  recipe.epsg = epsg;
  testing::make_raster(folder.file("flat.tif"), recipe);
  expect_done({"build", folder.file("flat.tif"), "-o", folder.file("flat.ptin"), "-q"});
  return answer_of({"sight", folder.file("flat.ptin"), "500500", "3997500", "1000", "539500",
                    "3997500", "1000", "--json"});
}

// From 10 m the horizon is 12 km away, from 1000 m 120 km.
TEST(BandUnit, CentimetresAreHiddenByTheEarth) {
  const json answer = sight_over_flat_ground("cm");
  EXPECT_EQ(answer.at("verdict"), "hidden");
  EXPECT_NEAR(answer.at("length").get<double>(), 39000.0 * 100, 1e-3);
}

TEST(BandUnit, MetresAreMetresHoweverTheyAreSpelled) {
  for (const char* unit : {"M", "Meter"}) {
    const json answer = sight_over_flat_ground(unit);
    EXPECT_EQ(answer.at("verdict"), "visible") << unit;
    EXPECT_NEAR(answer.at("length").get<double>(), 39000.0, 1e-6) << unit;
    EXPECT_EQ(answer.at("units").at("height"), "metre") << unit;
    EXPECT_EQ(answer.at("units").at("length"), "metre") << unit;
  }
}

// US survey feet of California's zone 2: 1000 of them see over 39 000.
TEST(BandUnit, UnknownNamesAreReckonedAndToldAsThePlanesUnit) {
  const json metres = sight_over_flat_ground("DN");
  EXPECT_NEAR(metres.at("length").get<double>(), 39000.0, 1e-6);
  EXPECT_EQ(metres.at("units").at("length"), "metre");
  const json feet = sight_over_flat_ground("DN", 2226);
  EXPECT_EQ(feet.at("verdict"), "visible");
  EXPECT_NEAR(feet.at("length").get<double>(), 39000.0, 1e-6);
  EXPECT_EQ(feet.at("units").at("length"), "US survey foot");
}

/// A square in US survey feet, in plane and height; its coordinates have more digits than a grid
/// keeps that reaches so far.
class MeshWithVerticalCrs : public ::testing::Test {
 protected:
  MeshWithVerticalCrs() {
    write_file(folder_.file("v.ply"),
               "ply\nformat ascii 1.0\ncomment crs: EPSG:2226\ncomment vertical_crs: EPSG:6360\n"
               "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
               "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
               "6000000.123456789012 2000000 1\n6000010 2000000 2\n"
               "6000010 2000010.987654321 3\n6000000 2000010 4\n3 0 1 2\n3 0 2 3\n");
  }
  json built(const std::vector<std::string>& options) {
    std::vector<std::string> all = {"build", folder_.file("v.ply"), "-o",    store_,
                                    "-q",    "--overwrite",         "--json"};
    all.insert(all.end(), options.begin(), options.end());
    return answer_of(all);
  }
  /// Code of the vertical CRS and unit of the heights.
  [[nodiscard]] json vertical() const {
    const json info = answer_of({"info", store_, "--json"});
    return {info.at("crs").at("vertical_code"), info.at("units").at("height")};
  }
  TestFolder folder_;
  std::string store_ = folder_.file("v.ptin");
};

TEST_F(MeshWithVerticalCrs, KeepsItsOwn) {
  built({});
  EXPECT_EQ(vertical(), (json{"EPSG:6360", "US survey foot"}));
}

TEST_F(MeshWithVerticalCrs, TakesAGivenCrsForAllThatItSays) {
  built({"--a-srs", "EPSG:2226+5703"});
  EXPECT_EQ(vertical(), (json{"EPSG:5703", "metre"}));
  built({"--a-srs", "EPSG:32610"});
  EXPECT_EQ(vertical(), (json{nullptr, "unknown"})) << "a plane alone: heights are not the file's";
  built({"--a-srs", "EPSG:32610", "--vertical-crs", "EPSG:5703"});
  EXPECT_EQ(vertical(), (json{"EPSG:5703", "metre"}));
}

TEST_F(MeshWithVerticalCrs, IsRepairedWithoutLosingItNorTheDigitsLeftOut) {
  const json whole = built({});
  const json repaired = built({"--repair"});
  EXPECT_EQ(vertical(), (json{"EPSG:6360", "US survey foot"}));
  EXPECT_GT(repaired.at("largest_shift").at("plan"), 0.0);
  EXPECT_EQ(repaired.at("largest_shift"), whole.at("largest_shift"));
}

}  // namespace
}  // namespace ptin::tools
