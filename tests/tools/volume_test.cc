// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin volume end to end.
#include <cmath>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::RasterRecipe;
using testing::run_ptin;
using testing::TestFolder;

class VolumeProgram : public ::testing::Test {
 protected:
  std::string store(const std::string& name, const RasterRecipe& recipe,
                    const std::vector<std::string>& more = {}) const {
    testing::make_raster(folder_.file(name + ".tif"), recipe);
    const std::string file = folder_.file(name + ".ptin");
    std::vector<std::string> arguments = {"build", folder_.file(name + ".tif"), "-o", file, "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    testing::expect_done(arguments);
    return file;
  }
  /// Of 32 x 32 cells; samples stand at the middles of 33 x 33 pixels.
  static RasterRecipe recipe(std::function<double(int, int)> value) {
    RasterRecipe r;
    r.value = std::move(value);
    return r;
  }
  static json ask(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "volume");
    arguments.emplace_back("--json");
    return testing::answer_of(arguments);
  }
  static double of(const json& answer, const char* name) {
    return answer.at(name).at("volume").get<double>();
  }

  TestFolder folder_;
};

TEST_F(VolumeProgram, MeasuresSeveralLevelsInOneAnswer) {
  const std::string plane = store("plane", recipe([](int column, int) { return double(column); }));
  const json all = ask({plane, "--interval", "8"});
  ASSERT_EQ(all.at("levels").size(), 5u);  // 0, 8, 16, 24, 32
  for (const json& level : all.at("levels")) {
    json one = ask({plane, "--level", level.at("level").dump()});
    for (const auto& [name, value] : level.items()) EXPECT_EQ(one.at(name), value) << name;
  }
}

TEST_F(VolumeProgram, WritesSeveralLevelsAsATable) {
  const std::string plane = store("plane", recipe([](int column, int) { return double(column); }));
  const testing::Outcome table = run_ptin({"volume", plane, "--level", "16", "8"});
  EXPECT_EQ(testing::lines_in(table.out), 3u) << table.out;
  EXPECT_TRUE(table.out.starts_with("level,cut,cut_low,cut_high,fill,")) << table.out;
  EXPECT_NE(table.out.find("\n16,"), std::string::npos) << table.out;
  const std::string file = plane + ".csv";
  testing::expect_done({"volume", plane, "--level", "16", "8", "-o", file, "-q"});
  EXPECT_EQ(testing::read_file(file), table.out);
  const testing::Outcome one = run_ptin({"volume", plane, "--level", "8", "-o", "-"});
  EXPECT_EQ(testing::lines_in(one.out), 2u) << one.out;
  for (const char* name : {".gpkg", ".xyz"}) {
    const Outcome other = run_ptin({"volume", plane, "--level", "8", "-o", plane + name});
    EXPECT_EQ(other.status, 2);
    EXPECT_NE(other.err.find("end the name in .csv, .png, .svg, .pdf"), std::string::npos)
        << other.err;
  }
  EXPECT_EQ(run_ptin({"volume", plane, "--against", plane, "-o", file}).status, 2);
  EXPECT_EQ(run_ptin({"volume", plane, "--interval", "0.0001"}).status, 2);
  EXPECT_EQ(run_ptin({"volume", plane, "--level", "8", "--json", "-o", "-"}).status, 2);
}

TEST_F(VolumeProgram, PlotsAStageStorageCurve) {
  const std::string plane = store("plane", recipe([](int column, int) { return double(column); }));
  const auto plot = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"volume", plane, "-o", plane + name, "-q"};
    words.insert(words.end(), more.begin(), more.end());
    testing::expect_done(words);
    return testing::read_file(plane + name);
  };
  const std::string exact = plot("1.svg", {"--interval", "8"});
  EXPECT_TRUE(exact.ends_with("</svg>\n"));
  EXPECT_EQ(exact.find("fill-opacity:0.35"), std::string::npos);
  EXPECT_TRUE(plot("2.png", {"--level", "16", "0", "32", "8", "24"}) ==
              plot("5.png", {"--interval", "8"}))
      << "in any order";
  EXPECT_NE(plot("3.svg", {"--interval", "8", "--error", "3"}).find("fill-opacity:0.35"),
            std::string::npos)
      << "the band of the certificate";
  EXPECT_TRUE(plot("4.pdf", {"--level", "8"}).starts_with("%PDF-"));
}

/// Right-angled prisms and a pyramid, whose volumes are known.
TEST_F(VolumeProgram, MeasuresAPlaneAndAPyramid) {
  const std::string plane = store("plane", recipe([](int column, int) { return double(column); }));
  const double side = 32 * 30.0;
  const json cut = ask({plane, "--level", "8"});
  EXPECT_NEAR(of(cut, "cut"), 24 * 30.0 * 24 / 2 * side, 1e-6);
  EXPECT_NEAR(of(cut, "fill"), 8 * 30.0 * 8 / 2 * side, 1e-6);
  EXPECT_NEAR(of(cut, "net"), 8 * side * side, 1e-6);
  EXPECT_NEAR(cut.at("area").at("cut").get<double>(), 24 * 30 * side, 1e-6);
  EXPECT_EQ(cut.at("area").at("surface"), side * side);
  EXPECT_NEAR(cut.at("mean_difference").get<double>(), 8, 1e-12);
  EXPECT_EQ(cut.at("exact"), true);
  EXPECT_EQ(cut.at("units").at("ground"), "metre");
  EXPECT_LT(cut.at("rounding"), 1e-6);
  const std::string pyramid = store("pyramid", recipe([](int column, int row) {
                                      return 16.0 - std::abs(column - 16) - std::abs(row - 16);
                                    }));
  const double base = 2 * 16 * 30.0 * 16 * 30.0;  // a square that stands on a corner
  EXPECT_NEAR(of(ask({pyramid, "--level", "0"}), "cut"), base * 16 / 3, 1e-5);
  // Above the level that halves its sides an eighth is left.
  EXPECT_NEAR(of(ask({pyramid, "--level", "8"}), "cut"), base * 16 / 24, 1e-5);
  const json between = ask({pyramid, "--against", plane});
  EXPECT_NEAR(of(between, "net"), -16 * side * side, 1e-5);
  EXPECT_EQ(between.at("level"), nullptr);
  EXPECT_EQ(between.at("against").at("certified_error"), 0.0);
}

TEST_F(VolumeProgram, CutsAtPolygonsWithHoles) {
  const std::string plane = store("plane", recipe([](int, int) { return 10.0; }));
  const std::string ring =
      "POLYGON((500100.5 3999900, 500400.5 3999900, 500400.5 3999600, 500100.5 3999600, "
      "500100.5 3999900), (500200 3999800, 500300 3999800, 500250 3999700, 500200 3999800))";
  const json answer = ask({plane, "--level", "7", "--polygon", ring});
  EXPECT_NEAR(of(answer, "cut"), 3 * (300 * 300 - 5000), 1e-6);
  const json window =
      ask({plane, "--level", "7", "--window", "500100", "3999000", "500130", "3999999"});
  EXPECT_NEAR(of(window, "cut"), 3.0 * 30 * (3999985 - 3999025), 1e-6);
}

TEST_F(VolumeProgram, TellsSurfaceOfOneAlone) {
  RasterRecipe part = recipe([](int column, int) { return column > 24 ? -9999.0 : 5.0; });
  part.nodata = -9999.0;
  const std::string file = store("part", part);
  RasterRecipe shifted = recipe([](int, int) { return 2.0; });
  shifted.west += 300;  // ten pixels
  const std::string other = store("other", shifted);
  const json answer = ask({file, "--against", other});
  const json& area = answer.at("area");
  EXPECT_NEAR(of(answer, "cut"), 3.0 * 14 * 30 * 32 * 30, 1e-5);
  EXPECT_NEAR(area.at("surface").get<double>(), 14 * 30 * 32 * 30, 1e-6);
  EXPECT_NEAR(area.at("void").get<double>(), 8 * 30 * 32 * 30, 1e-6);
  EXPECT_NEAR(area.at("only_file").get<double>(), 10 * 30 * 32 * 30, 1e-6);
  EXPECT_NEAR(area.at("only_against").get<double>(), 18 * 30 * 32 * 30, 1e-6);
}

TEST_F(VolumeProgram, TurnsUnitsAndRefusesWhatCannotBeCompared) {
  RasterRecipe metres = recipe([](int, int) { return 3.048; });
  metres.unit = "m";
  RasterRecipe feet = recipe([](int, int) { return 5.0; });
  feet.unit = "ft";
  const std::string in_metres = store("m", metres), in_feet = store("ft", feet);
  const double square = 32 * 30.0 * 32 * 30.0;
  // Float32 has 3.048 to 1e-7.
  EXPECT_NEAR(of(ask({in_metres, "--against", in_feet}), "cut") / square, 5 * 0.3048, 1e-6);
  const json answer = ask({in_feet, "--against", in_metres});
  EXPECT_EQ(answer.at("units").at("ground"), "foot");
  EXPECT_NEAR(of(answer, "fill") / square * 0.3048 * 0.3048, 5, 1e-5);
  RasterRecipe elsewhere = metres;
  elsewhere.epsg = 32612;
  const Outcome refused = run_ptin({"volume", in_metres, "--against", store("other", elsewhere)});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("is not that of"), std::string::npos) << refused.err;
  RasterRecipe nowhere = metres;
  nowhere.epsg = 0;
  const Outcome warned = run_ptin({"volume", in_metres, "--against", store("none", nowhere)});
  EXPECT_EQ(warned.status, 0) << warned.err;
  EXPECT_NE(warned.err.find("CRS of"), std::string::npos) << warned.err;
}

/// In a CRS in feet, whose unit must not stand in for one that nobody told.
TEST_F(VolumeProgram, TakesHeightsOfNoUnitForThoseOfTheOtherTerrain) {
  RasterRecipe untold = recipe([](int column, int) { return 1.0 + column; });
  untold.epsg = 2263;
  RasterRecipe metres = untold;
  metres.unit = "m";
  const std::string of_none = store("none", untold), in_metres = store("metres", metres);
  for (const auto& [file, other] : {std::pair{of_none, in_metres}, {in_metres, of_none}}) {
    const Outcome outcome = run_ptin({"volume", file, "--against", other});
    EXPECT_NE(outcome.err.find("unit of the heights of " + of_none), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.out.find("mean  0 metre"), std::string::npos) << outcome.out;
  }
}

TEST_F(VolumeProgram, GivesIntervalsAtAnError) {
  const std::string file = testing::built(folder_, "coast_257.tif");
  const json exact = ask({file, "--level", "50"}),
             rough = ask({file, "--level", "50", "--error", "9"});
  for (const char* name : {"cut", "fill", "net"}) {
    EXPECT_LE(rough.at(name).at("low"), of(exact, name)) << name;
    EXPECT_GE(rough.at(name).at("high"), of(exact, name)) << name;
  }
  EXPECT_EQ(rough.at("exact"), false);
  EXPECT_GT(rough.at("border_moved_at_most"), 0.0);
  const std::string text = run_ptin({"volume", file, "--level", "50", "--error", "9"}).out;
  EXPECT_NE(text.find("the source's between"), std::string::npos) << text;
  EXPECT_EQ(run_ptin({"volume", file, "--level", "50"}).out.find("between"), std::string::npos);
}

}  // namespace
}  // namespace ptin::tools
