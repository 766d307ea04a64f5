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

/// A square of 10 units a side whose file names its units, and perhaps a CRS.
class LandXmlWithUnits : public ::testing::Test {
 protected:
  json built(const std::string& units, const std::string& more,
             const std::vector<std::string>& options) {
    write(units, more);
    std::vector<std::string> all = {"build", file_, "-o", store_, "-q", "--overwrite"};
    all.insert(all.end(), options.begin(), options.end());
    expect_done(all);
    return answer_of({"info", store_, "--json"}).at("units");
  }
  void write(const std::string& units, const std::string& more) const {
    write_file(file_, "<LandXML>" + more + "<Units>" + units +
                          "</Units><Surfaces><Surface name=\"s\"><Definition surfType=\"TIN\">"
                          "<Pnts><P id=\"1\">0 0 1</P><P id=\"2\">0 10 2</P><P id=\"3\">10 10 3</P>"
                          "<P id=\"4\">10 0 4</P></Pnts><Faces><F>1 2 3</F><F>1 3 4</F></Faces>"
                          "</Definition></Surface></Surfaces></LandXML>");
  }
  /// Metres in a unit of x, y (up) and height, as a GLB has them.
  json scale() const {
    const std::string glb = folder_.file("m.glb");
    expect_done({"refine", store_, "-o", glb, "--overwrite"});
    const std::string bytes = testing::read_file(glb);
    const std::size_t begin = bytes.find('{');
    const std::size_t end = bytes.find("BIN") - 4;  // before the chunk's length
    const json scene = json::parse(bytes.substr(begin, end - begin));
    return scene.at("nodes").at(0).at("extras").at("scale");
  }
  TestFolder folder_;
  std::string file_ = folder_.file("s.xml"), store_ = folder_.file("s.ptin");
};

TEST_F(LandXmlWithUnits, KeepsThemWithoutACrs) {
  EXPECT_EQ(built(R"(<Imperial linearUnit="foot"/>)", "", {}),
            (json{{"horizontal", "foot"}, {"height", "foot"}}));
  EXPECT_EQ(scale(), (json{0.3048, 0.3048, 0.3048}));
  for (const char* repair : {"--repair", "--overwrite"}) {
    EXPECT_EQ(built(R"(<Imperial linearUnit="USSurveyFoot" elevationUnit="meter"/>)", "", {repair}),
              (json{{"horizontal", "US survey foot"}, {"height", "metre"}}));
    const json told = scale();
    EXPECT_DOUBLE_EQ(told.at(0).get<double>(), 1200.0 / 3937.0);
    EXPECT_EQ(told.at(2), 1.0);
  }
}

TEST_F(LandXmlWithUnits, KeepsThoseOfTheHeightsBesideACrs) {
  const std::string feet = R"(<Imperial linearUnit="USSurveyFoot"/>)";
  EXPECT_EQ(built(feet, "<CoordinateSystem epsgCode=\"2226\"/>", {}),
            (json{{"horizontal", "US survey foot"}, {"height", "US survey foot"}}));
  EXPECT_EQ(built(R"(<Imperial linearUnit="foot"/>)", "<CoordinateSystem epsgCode=\"2226\"/>", {}),
            (json{{"horizontal", "US survey foot"}, {"height", "foot"}}))
      << "the two feet are confused too often to refuse them";
  EXPECT_EQ(built(feet, "", {"--a-srs", "EPSG:2226+5703"}).at("height"), "metre");
}

TEST_F(LandXmlWithUnits, RefusesACrsOfOtherUnits) {
  write(R"(<Imperial linearUnit="foot"/>)", "<CoordinateSystem epsgCode=\"32610\"/>");
  const testing::Outcome refused = testing::run_ptin({"build", file_, "-o", store_, "-q"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("units of 'foot', but the unit of the CRS that it names is 'metre'"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(built(R"(<Imperial linearUnit="foot"/>)", "", {"--a-srs", "EPSG:32610"}),
            (json{{"horizontal", "metre"}, {"height", "foot"}}));
}

}  // namespace
}  // namespace ptin::tools
