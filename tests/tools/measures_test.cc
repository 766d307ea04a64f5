// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lengths and heights of the command line with a unit behind them: of every option that is one.
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/measures_with_units.h"
#include "tests/tools/program.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"
#include "tools/ptin/command.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_and_file;
using testing::answer_of;
using testing::expect_done;
using testing::MeasuresWithUnits;
using testing::Outcome;
using testing::questions_of;
using testing::read_file;
using testing::run_ptin;
using Spoken = testing::Spoken;

/// Options of `build`, which knows no unit before its source is read.
const std::set<std::string> kPlain = {"build --max-error", "build --max-edge",
                                      "build --resolution"};
TEST_F(MeasuresWithUnits, MayHaveBlanksBeforeThem) {
  const std::string feet = built("feet", 2913, "foot");
  EXPECT_EQ(answer_and_file({"volume", feet}, "--level", " 5"),
            answer_and_file({"volume", feet}, "--level", "5"));
  EXPECT_EQ(parse_bytes(" 5M", "--memory"), std::uint64_t{5} << 20);
}

TEST_F(MeasuresWithUnits, AreRefusedInUnitsThatNobodyKnows) {
  const std::string feet = built("feet", 2913, "foot");
  expect_done({"stream", feet, "-o", file("sent.pts"), "-q"});
  const auto refused = [](Spoken words, const std::string& option, const std::string& value) {
    if (option.starts_with("-")) {
      words.insert(words.end(), {option, value});
    } else {
      words.insert(words.begin() + 4, value);
    }
    const Outcome outcome = run_ptin(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  };
  for (const auto& [name, question] : questions_of(feet, folder_)) {
    SCOPED_TRACE(name);
    const std::string option = name.substr(name.find(' ') + 1);
    const std::string said = refused(question.words, option, "3parsec");
    EXPECT_NE(said.find(option + ": must be"), std::string::npos) << said;
    EXPECT_NE(said.find("or with a unit behind it (mm, cm, m, km, in, ft, us-ft, yd, mi), as 10ft; "
                        "3parsec is none"),
              std::string::npos)
        << said;
  }
  const std::string nowhere = built("nowhere", 0, "");
  const std::string height =
      refused({"isoline", nowhere, "-o", file("a.gpkg")}, "--interval", "10ft");
  EXPECT_NE(
      height.find("--interval: the unit of the terrain's heights is unknown, so 10ft cannot be "
                  "turned into it; give a number without a unit"),
      std::string::npos)
      << height;
  const std::string length = refused(
      {"viewshed", nowhere, "7600500", "599500", "5", "-o", file("a.tif")}, "--radius", "1km");
  EXPECT_NE(length.find("--radius: the unit of the terrain's map is unknown"), std::string::npos)
      << length;
  for (const std::string& name : kPlain) {
    const std::string said = refused({"build", file("feet.tif"), "-o", file("b.ptin")},
                                     name.substr(name.find(' ') + 1), "3m");
    EXPECT_NE(said.find("must be a plain number"), std::string::npos) << said;
  }
}

/// Heights of no known unit are taken in the plane's, as for slopes; in degrees lengths are metres.
TEST_F(MeasuresWithUnits, AreInWhatIsTakenForTheUnit) {
  const std::string metres = built("metres", 32611, "");
  const auto levels = [&](const std::string& interval) {
    return answer_of({"volume", metres, "--interval", interval, "--json"}).at("levels");
  };
  EXPECT_EQ(levels("50ft"), levels("15.24"));
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 10;
  recipe.north = 46;
  recipe.pixel = 0.001;
  recipe.value = testing::hills;
  testing::make_raster(file("degrees.tif"), recipe);
  expect_done({"build", file("degrees.tif"), "-o", file("degrees.ptin"), "-q"});
  const auto seen = [&](const std::string& radius) {
    expect_done({"viewshed", file("degrees.ptin"), "10.016", "45.984", "5", "--radius", radius,
                 "-o", file("seen.tif"), "--overwrite", "-q"});
    return read_file(file("seen.tif"));
  };
  EXPECT_EQ(seen("0.5km"), seen("500"));
}

TEST(Length, IsANumberAndAUnit) {
  EXPECT_EQ(length_of("5km")->in(1), 5000);
  EXPECT_EQ(length_of("-3 ft")->in(0.3048), -3);
  EXPECT_EQ(length_of("10ft")->in(1200.0 / 3937.0), 10) << "the two feet are one";
  EXPECT_EQ(length_of("1mi")->in(1), 1609.344);
  EXPECT_EQ(length_of("0.5m")->in(0.3048), 0.5 / 0.3048);
  EXPECT_FALSE(length_of("7")->has_unit());
  for (const char* text : {"", "m", "5 parsec", "5miles", "nan", "5m m", "5M"}) {
    EXPECT_FALSE(length_of(text)) << text;
  }
}

}  // namespace
}  // namespace ptin::tools
