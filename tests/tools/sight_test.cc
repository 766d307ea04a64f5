// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin sight against numbers computed by hand: the Fresnel zone, the length over ground; and where
// its pairs come from.
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::Outcome;
using testing::run_ptin;
using testing::spawn_ptin_reading;
using testing::TestFolder;
using testing::write_file;

constexpr double kColumnWidth = 30;
constexpr double kWavelength = 299792458.0 / 1e9;  // m, at 1 GHz
constexpr double kEarthDiameter = 2 * 6378137.0;

std::string x_of(double column) { return std::to_string(500015.0 + kColumnWidth * column); }
const char* const kRowY = "3999385";  // row 20

/// Flat ground of 10 with a wall of 100 across column 16.
class SightNumbers : public ::testing::Test {
 protected:
  SightNumbers() {
    testing::RasterRecipe recipe;
    recipe.value = [](int column, int) { return column == 16 ? 100.0 : 10.0; };
    testing::make_raster(folder_.file("wall.tif"), recipe);
    testing::expect_done({"build", folder_.file("wall.tif"), "-o", file_, "-q"});
  }
  /// Along row 20, both ends at one height.
  [[nodiscard]] json asked(double from, double to, const std::string& height,
                           const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"sight",  file_, x_of(from), kRowY,   height,
                                    x_of(to), kRowY, height,     "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return answer_of(all);
  }
  TestFolder folder_;
  std::string file_ = folder_.file("wall.ptin");
};

/// Of the first Fresnel zone.
double zone_radius(double d1, double d2) { return std::sqrt(kWavelength * d1 * d2 / (d1 + d2)); }

TEST_F(SightNumbers, FresnelRatioIsTheClearanceOverTheRadiusOfTheZone) {
  // Above ground 140, so 50 above the wall, 180 m from one end and 360 m from the other.
  const json flat = asked(10, 28, "140", {"--frequency", "1e9", "--curvature", "0"});
  EXPECT_EQ(flat.at("verdict"), "visible");
  EXPECT_NEAR(flat.at("fresnel").at("ratio").get<double>(), 50 / zone_radius(180, 360), 1e-9);
  EXPECT_NEAR(flat.at("fresnel").at("distance").get<double>(), 180, 1e-6);
  EXPECT_NEAR(flat.at("fresnel").at("height").get<double>(), 150, 1e-9);
  const double sinks = 0.5 * 180 * 360 / kEarthDiameter;
  const json bent = asked(10, 28, "140", {"--frequency", "1e9", "--curvature", "0.5"});
  EXPECT_NEAR(bent.at("fresnel").at("ratio").get<double>(), (50 - sinks) / zone_radius(180, 360),
              1e-9);
  EXPECT_EQ(asked(10, 28, "140", {}).count("fresnel"), 0U) << "not asked for";
}

TEST_F(SightNumbers, FrequenciesHaveUnits) {
  const json plain = asked(10, 28, "140", {"--frequency", "5.8e9"}).at("fresnel");
  for (const char* text : {"5.8GHz", "5800MHz", "5.8 ghz", "5800000kHz", "5800000000Hz"}) {
    const json given = asked(10, 28, "140", {"--frequency", text}).at("fresnel");
    EXPECT_NEAR(given.at("ratio").get<double>(), plain.at("ratio").get<double>(), 1e-12) << text;
  }
}

TEST_F(SightNumbers, FrequenciesThatNobodyMeansAreRefused) {
  const auto refuse = [&](const char* text, const std::string& words) {
    const auto outcome = testing::run_ptin(
        {"sight", file_, x_of(10), kRowY, "9", x_of(28), kRowY, "9", "--frequency", text});
    EXPECT_EQ(outcome.status, 2) << text;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("ptin: --frequency: " + words), std::string::npos) << outcome.err;
  };
  refuse("5.8", "5.8 hertz is no radio link's frequency, which is 1 MHz at least; give the unit");
  refuse("5800", "5800 hertz");
  refuse("999kHz", "999000 hertz");
  refuse("0", "0 hertz");
  refuse("-5.8GHz", "-5.8e+09 hertz");
  for (const char* text : {"", "fast", "5.8GH", "nan", "inf", "1e400", "5,8GHz"}) {
    refuse(text, std::string("\"") + text + "\" is no frequency");
  }
}

TEST_F(SightNumbers, FresnelRatioOfAHiddenLineIsBelowZero) {
  // 40 above ground is 50 below the wall's top.
  const json low = asked(10, 28, "40", {"--frequency", "1e9", "--curvature", "0"});
  EXPECT_EQ(low.at("verdict"), "hidden");
  EXPECT_NEAR(low.at("fresnel").at("ratio").get<double>(), -50 / zone_radius(180, 360), 1e-9);
}

TEST_F(SightNumbers, FresnelRatioOverFlatGroundIsLeastInTheMiddle) {
  const json over = asked(18, 30, "7", {"--frequency", "1e9", "--curvature", "0"});
  EXPECT_NEAR(over.at("fresnel").at("ratio").get<double>(), 7 / zone_radius(180, 180), 1e-9);
  EXPECT_NEAR(over.at("fresnel").at("distance").get<double>(), 180, 1e-3);
  // Half of the frequency: a zone wider by the root of two.
  const json wider = asked(18, 30, "7", {"--frequency", "0.5e9", "--curvature", "0"});
  EXPECT_NEAR(wider.at("fresnel").at("ratio").get<double>(),
              7 / zone_radius(180, 180) / std::sqrt(2.0), 1e-9);
}

TEST_F(SightNumbers, VerdictAloneIsTheSameVerdict) {
  for (const auto& [height, verdict] : {std::pair{"5", "hidden"}, std::pair{"140", "visible"}}) {
    const json whole = asked(4, 28, height, {});
    const json alone = asked(4, 28, height, {"--verdict"});
    EXPECT_EQ(whole.at("verdict"), verdict);
    EXPECT_EQ(alone.at("verdict"), verdict);
    EXPECT_FALSE(whole.at("clearance").is_null());
    EXPECT_TRUE(alone.at("clearance").is_null());
    EXPECT_EQ(alone.at("obstruction").is_null(), whole.at("obstruction").is_null());
    EXPECT_LE(alone.at("cost").at("records_retrieved"), whole.at("cost").at("records_retrieved"));
  }
  // Some point below ground: on the wall, whose sides are at 11 and 13 columns.
  const json alone = asked(4, 28, "5", {"--verdict"});
  EXPECT_GT(alone.at("obstruction").at("distance"), kColumnWidth * 11);
  EXPECT_LT(alone.at("obstruction").at("distance"), kColumnWidth * 13);
}

TEST_F(SightNumbers, PairsOnStandardInputAreThoseOfAFile) {
  std::ostringstream rows;
  rows << "x1,y1,h1,x2,y2,h2\n";
  for (const char* height : {"1", "200", "5", "150"}) {
    rows << x_of(4) << ',' << kRowY << ',' << height << ',' << x_of(28) << ',' << kRowY << ','
         << height << '\n';
  }
  write_file(folder_.file("pairs.csv"), rows.str());
  const Outcome of_file = run_ptin({"sight", file_, "--pairs", folder_.file("pairs.csv")});
  const Outcome of_input = spawn_ptin_reading(rows.str(), {"sight", file_, "--pairs", "-"});
  EXPECT_EQ(of_input.status, 0) << of_input.err;
  EXPECT_EQ(of_input.out, of_file.out);
  std::istringstream lines(of_input.out);
  std::string line;
  std::getline(lines, line);
  for (const char* verdict : {"hidden,", "visible,", "hidden,", "visible,"}) {
    std::getline(lines, line);
    EXPECT_EQ(line.find(verdict), 0U) << line;
  }
  EXPECT_EQ(spawn_ptin_reading("1 2 3 4 5\n", {"sight", file_, "--pairs", "-"}).status, 2);
}

// Their products are infinite, and the difference of two such is no number.
TEST_F(SightNumbers, AreRefusedWhereTheyAreTooLargeToReckonWith) {
  const std::vector<std::string> line = {x_of(4), kRowY, "5", x_of(28), kRowY, "5"};
  const auto expect_refused = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"sight", file_});
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(testing::lines_in(outcome.err), 1U) << outcome.err;
  };
  std::vector<std::string> bent = line;
  bent.emplace_back("--curvature=1e308");
  expect_refused(bent);
  std::vector<std::string> near_end = line, far_end = line;
  near_end[2] = far_end[5] = "1e308";
  far_end.emplace_back("--absolute");
  expect_refused(near_end);
  expect_refused(far_end);
}

/// Length of the meridian of WGS 84 between two latitudes, degrees: Simpson's rule over its radius
/// of curvature.
double meridian(double from, double to) {
  constexpr double kA = 6378137.0, kF = 1 / 298.257223563, kE2 = kF * (2 - kF);
  const auto at = [](double degrees) {
    const double sine = std::sin(degrees * M_PI / 180);
    return kA * (1 - kE2) / std::pow(1 - kE2 * sine * sine, 1.5);
  };
  constexpr int kSteps = 1000;
  const double h = (to - from) / kSteps;
  double sum = at(from) + at(to);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4 : 2) * at(from + i * h);
  return sum * h / 3 * M_PI / 180;
}

// A wall with a gap of void, which a level closes by surface: what is not settled hides nothing.
TEST(SightThroughAGap, IsNeverHiddenByALevelThatClosesTheGap) {
  const TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    const bool in_gap = column >= 14 && column <= 18 && row >= 18 && row <= 22;
    const bool in_lake = column >= 10 && column <= 22 && row >= 25;  // else the gap is never lost
    return in_gap || in_lake ? -9999.0 : (column == 16 ? 5000.0 : 10.0);
  };
  testing::make_raster(folder.file("gap.tif"), recipe);
  testing::expect_done({"build", folder.file("gap.tif"), "-o", folder.file("gap.ptin"), "-q"});
  for (const char* way : {"stars", "splits"}) {
    const std::vector<std::string> line = {
        "sight", folder.file("gap.ptin"), x_of(2), kRowY, "9", x_of(30), kRowY, "9", "--by", way,
        "--json"};
    const json exact = answer_of(line);
    EXPECT_EQ(exact.at("verdict"), "visible");
    EXPECT_GT(exact.at("void_length").get<double>(), 0.0);
    for (const char* error : {"30", "60", "90", "120", "200", "400", "1000"}) {
      for (const bool verdict_only : {false, true}) {
        std::vector<std::string> asked = line;
        asked.insert(asked.end(), {"--error", error});
        if (verdict_only) asked.push_back("--verdict");
        EXPECT_NE(answer_of(asked).at("verdict"), "hidden") << way << " at " << error;
      }
    }
  }
}

TEST(SightInDegrees, MeasuresAlongTheEllipsoid) {
  const TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.value = [](int, int) { return 0.0; };
  recipe.epsg = 4326;
  recipe.pixel = 0.05;
  recipe.west = 10 - 0.025;
  recipe.north = 46 + 0.025;
  testing::make_raster(folder.file("flat.tif"), recipe);
  const std::string file = folder.file("flat.ptin");
  testing::expect_done({"build", folder.file("flat.tif"), "-o", file, "-q"});
  const auto length = [&](const char* x1, const char* y1, const char* x2, const char* y2) {
    return answer_of({"sight", file, x1, y1, "9", x2, y2, "9", "--json", "--curvature", "0"})
        .at("length")
        .get<double>();
  };
  EXPECT_NEAR(meridian(44.5, 45.5), 111131.778, 1e-3);
  EXPECT_NEAR(length("10.5", "44.5", "10.5", "45.5"), meridian(44.5, 45.5), 1e-4);
  EXPECT_NEAR(length("10.5", "45.5", "10.5", "45.55"), meridian(45.5, 45.55), 1e-4);
  // Across meridians the shortest way is a little shorter than the parallel: a cos(lat) / w a radian.
  const double parallel = 78846.835;  // a degree at 45 N
  const double across = length("10.1", "45", "11.1", "45");
  EXPECT_LT(across, parallel);
  EXPECT_NEAR(across, parallel, 1.0);
  EXPECT_NEAR(length("10.1", "45", "10.2", "45"), parallel / 10, 1e-2);
  const json answer =
      answer_of({"sight", file, "10.5", "44.5", "9", "10.5", "45.5", "9", "--json"});
  EXPECT_EQ(answer.at("verdict"), "hidden") << "the Earth's curvature, in metres";
}

/// Heights that are rounded move no border of a void: what stands between voids hides all the same.
TEST(SightOverVoids, IsDecidedWhereHeightsAloneAreRounded) {
  const TestFolder folder;
  // Three squares with gaps between them: ground, a wall, ground; no step of heights holds such digits.
  std::string obj;
  for (int k = 0; k < 3; ++k) {
    const std::string height = k == 1   ? "5.3333333333333333"
                               : k == 0 ? "0.33333333333333331"
                                        : "0.3141592653589793";
    for (const auto& [x, y] :
         {std::pair(0, 0), std::pair(10, 0), std::pair(10, 10), std::pair(0, 10)}) {
      obj += "v " + std::to_string(20 * k + x) + " " + std::to_string(y) + " " + height + "\n";
    }
  }
  for (const int first : {1, 5, 9}) {
    const auto corner = [first](int i) { return " " + std::to_string(first + i); };
    obj +=
        "f" + corner(0) + corner(1) + corner(2) + "\nf" + corner(0) + corner(2) + corner(3) + "\n";
  }
  write_file(folder.file("walls.obj"), obj);
  const std::string file = folder.file("walls.ptin");
  testing::expect_done({"build", folder.file("walls.obj"), "-o", file, "-q"});
  ASSERT_GT(answer_of({"info", file, "--json"}).at("base_error").get<double>(), 0.0);
  for (const std::string way : {"stars", "splits"}) {
    const json hidden =
        answer_of({"sight", file, "5", "4", "2", "45", "6", "2", "--json", "--by", way});
    EXPECT_EQ(hidden.at("verdict"), "hidden") << way;
    EXPECT_NEAR(hidden.at("clearance").at("max").get<double>(), -3.0, 0.02) << way;
    EXPECT_NEAR(hidden.at("void_length").get<double>(), std::hypot(40, 2) / 2, 1e-6) << way;
    const json seen =
        answer_of({"sight", file, "5", "4", "9", "45", "6", "9", "--json", "--by", way});
    EXPECT_EQ(seen.at("verdict"), "visible") << way;
  }
}

}  // namespace
}  // namespace ptin::tools
