// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lengths and heights of the command line with a unit behind them: of every option that is one.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"
#include "tools/ptin/command.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using Spoken = std::vector<std::string>;

/// Options of `build`, which knows no unit before its source is read.
const std::set<std::string> kPlain = {"build --max-error", "build --max-edge",
                                      "build --resolution"};
/// Real numbers that are no length or height.
const std::set<std::string> kNumbers = {
    "refine --exaggeration", "export --exaggeration", "export --nodata",
    "export --azimuth",      "export --altitude",     "sight PAIR",
    "sight --curvature",     "viewshed --curvature",  "bench --seconds",
    "build --nodata",        "build --void-slope"};

/// Hills of 33 x 33 samples in Oregon, plan and heights in feet; or in another CRS.
class Measured : public ::testing::Test {
 protected:
  [[nodiscard]] std::string built(const std::string& name, int epsg,
                                  const std::string& unit) const {
    testing::RasterRecipe recipe;
    recipe.epsg = epsg;
    recipe.unit = unit;
    recipe.value = testing::hills;
    recipe.west = 7600000;
    recipe.north = 600000;
    testing::make_raster(file(name + ".tif"), recipe);
    expect_done({"build", file(name + ".tif"), "-o", file(name + ".ptin"), "-q"});
    return file(name + ".ptin");
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  TestFolder folder_;
};

/// A question in which an option counts, without it; and how many metres are a value for it.
struct AskedWith {
  Spoken words;
  double metres = 3;
};

/// By subcommand and option.
std::map<std::string, AskedWith> questions_of(const std::string& feet, const TestFolder& folder) {
  const auto out = [&](const char* name) { return folder.file(name); };
  const std::string line = "LINESTRING(7600100 599900, 7600800 599200)";
  const Spoken viewshed = {"viewshed", feet, "7600500", "599500"};
  const auto seen = [&](Spoken more) {
    Spoken words = viewshed;
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", out("a.tif")});
    return words;
  };
  const Spoken unstream = {"unstream", folder.file("sent.pts"), "-o", out("a.geojson")};
  const Spoken stream = {"stream", feet, "-o", out("a.pts")};
  Spoken based = {"isoline", feet, "-o", out("a.geojson"), "--interval", "20"};
  Spoken base_of_stream = unstream, base_of_volume = {"volume", feet, "--interval", "20"};
  base_of_stream.insert(base_of_stream.end(), {"--interval", "20"});
  return {
      {"refine --error", {{"refine", feet, "-o", out("a.ply")}, 1}},
      {"refine --solid", {{"refine", feet, "-o", out("a.stl")}, -30}},
      {"export --error", {{"export", feet, "-o", out("a.ply")}, 1}},
      {"export --solid", {{"export", feet, "-o", out("a.stl")}, -30}},
      {"isoline --error", {{"isoline", feet, "--level", "9", "-o", out("a.geojson")}, 1}},
      {"isoline --level", {{"isoline", feet, "-o", out("a.geojson")}}},
      {"isoline --interval", {{"isoline", feet, "-o", out("a.geojson")}, 9}},
      {"isoline --base", {based}},
      {"locate --error", {{"locate", feet, "7600500", "599500"}, 1}},
      {"profile --error", {{"profile", feet, "--line", line}, 1}},
      {"profile --stations", {{"profile", feet, "--line", line}, 30}},
      {"sight --error", {{"sight", feet, "7600100", "599900", "5", "7600800", "599200", "5"}, 1}},
      {"viewshed --error", {seen({"5", "--radius", "400"}), 1}},
      {"viewshed --radius", {seen({"5"}), 100}},
      {"viewshed --target-height", {seen({"5", "--radius", "400"})}},
      {"viewshed H", {seen({"--radius", "400"})}},
      {"highest --error", {{"highest", feet}, 1}},
      {"volume --error", {{"volume", feet, "--level", "9"}, 1}},
      {"volume --level", {{"volume", feet}}},
      {"volume --interval", {{"volume", feet}, 9}},
      {"volume --base", {base_of_volume}},
      {"stream --error", {stream, 1}},
      {"stream --level", {stream, 25}},
      {"stream --have-error", {stream, 1}},
      {"stream --have-level", {stream, 25}},
      {"unstream --level", {unstream}},
      {"unstream --interval", {unstream, 9}},
      {"unstream --base", {base_of_stream}},
      {"render --error", {{"render", feet, "--size", "90", "90", "-o", out("a.png")}, 1}},
      {"render --contours", {{"render", feet, "--size", "90", "90", "-o", out("a.png")}, 9}},
      {"bench --error", {{"bench", feet, "--seconds", "0.01", "--count", "1"}, 1}},
      {"verify --tolerance", {{"verify", feet, "--against", folder.file("feet.tif")}, 1}}};
}

/// The options and arguments of all subcommands that are lengths or heights. Every other real number
/// is a position, or one of kNumbers.
std::set<std::string> measures_of_the_program() {
  std::set<std::string> all;
  for (const Command& command : commands()) {
    Context context;
    const Declared declared = command.declare(context);
    for (const ask::Parameter& row : declared.parameters) {
      if (!is_at(row.doors, ask::Door::kProgram)) continue;
      const std::string name =
          std::string(command.name) + " " + ask::name_at(row, ask::Door::kProgram);
      const bool is_measure = row.unit == ask::Unit::kHeight || row.unit == ask::Unit::kGround;
      if (is_measure) all.insert(name);
      const bool is_real = !ask::is_text(row) && !ask::is_flag(row) && !ask::is_whole(row);
      const bool has_no_unit = row.unit == ask::Unit::kNone && row.source_unit.empty();
      EXPECT_EQ(is_real && has_no_unit, kNumbers.contains(name)) << name;
    }
  }
  return all;
}

/// The answer without what differs from run to run, and what was written.
struct AnswerAndFile {
  json answer;
  std::string written;
  bool operator==(const AnswerAndFile&) const = default;
};

AnswerAndFile answer_and_file(Spoken words, const std::string& option, const std::string& value) {
  if (option.starts_with("-")) {
    words.insert(words.end(), {option, value});
  } else {
    words.insert(words.begin() + 4, value);  // of viewshed, behind X and Y
  }
  const auto output = std::find(words.begin(), words.end(), "-o");
  const std::string path = output == words.end() ? "" : *(output + 1);
  words.insert(words.end(), {"--json", "-q"});
  if (!path.empty()) words.emplace_back("--overwrite");
  AnswerAndFile told{answer_of(words), path.empty() ? "" : read_file(path)};
  if (told.answer.contains("cost")) told.answer["cost"].erase("seconds");
  told.answer.erase("seconds");
  return told;
}

TEST_F_IN_RELEASE(Measured, AllLengthsAndHeightsTakeUnits) {
  const std::string feet = built("feet", 2913, "foot");
  expect_done({"stream", feet, "-o", file("sent.pts"), "-q"});
  const std::map<std::string, AskedWith> questions = questions_of(feet, folder_);
  for (const std::string& name : measures_of_the_program()) {
    SCOPED_TRACE(name);
    const auto question = questions.find(name);
    EXPECT_TRUE(question != questions.end()) << "a new length or height: put it into the table";
    if (question == questions.end()) continue;
    const std::string option = name.substr(name.find(' ') + 1);
    const auto& [words, metres] = question->second;
    const std::string plain = exact_number(metres / 0.3048);
    if (words.front() == "bench") {  // figures of time: what was asked is told
      EXPECT_EQ(answer_and_file(words, option, exact_number(metres) + "m").answer.at("error"),
                metres / 0.3048);
      continue;
    }
    const AnswerAndFile want = answer_and_file(words, option, plain);
    EXPECT_EQ(answer_and_file(words, option, exact_number(metres) + "m"), want);
    EXPECT_EQ(answer_and_file(words, option, plain + "us-ft"), want) << "the terrain's own foot";
    EXPECT_NE(answer_and_file(words, option, exact_number(2 * metres)), want) << "it has no effect";
  }
}

TEST_F(Measured, MayHaveBlanksBeforeThem) {
  const std::string feet = built("feet", 2913, "foot");
  EXPECT_EQ(answer_and_file({"volume", feet}, "--level", " 5"),
            answer_and_file({"volume", feet}, "--level", "5"));
  EXPECT_EQ(parse_bytes(" 5M", "--memory"), std::uint64_t{5} << 20);
}

TEST_F(Measured, AreRefusedInUnitsThatNobodyKnows) {
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
TEST_F(Measured, AreInWhatIsTakenForTheUnit) {
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
