// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions in which lengths and heights count, of a terrain in feet, and their answers.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

using Spoken = std::vector<std::string>;

/// Hills of 33 x 33 samples in Oregon, plan and heights in feet; or in another CRS.
class MeasuresWithUnits : public ::testing::Test {
 protected:
  [[nodiscard]] std::string built(const std::string& name, int epsg,
                                  const std::string& unit) const {
    RasterRecipe recipe;
    recipe.epsg = epsg;
    recipe.unit = unit;
    recipe.value = hills;
    recipe.west = 7600000;
    recipe.north = 600000;
    make_raster(file(name + ".tif"), recipe);
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
inline std::map<std::string, AskedWith> questions_of(const std::string& feet,
                                                     const TestFolder& folder) {
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

/// The answer without what differs from run to run, and what was written.
struct AnswerAndFile {
  nlohmann::json answer;
  std::string written;
  bool operator==(const AnswerAndFile&) const = default;
};

inline AnswerAndFile answer_and_file(Spoken words, const std::string& option,
                                     const std::string& value) {
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

}  // namespace ptin::tools::testing
