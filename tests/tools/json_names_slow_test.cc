// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lists of JSON names in tools/API.md against what every subcommand prints: no name that the
// lists do not have, none of theirs that never comes, no value of another type, and the same words
// for the same things.
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using Words = std::set<std::string>;
/// The types of each name. `a.b` is `b` of the object `a`, `a[].b` is `b` of the objects of `a`.
using Names = std::map<std::string, Words>;

/// What stands between the first two backticks.
std::string first_code(const std::string& line) {
  const std::size_t begin = line.find('`') + 1;
  return begin == 0 ? std::string() : line.substr(begin, line.find('`', begin) - begin);
}

/// "number or null" as two words; of "array of numbers" the first word alone.
Words types_in(const std::string& text) {
  std::istringstream words(text);
  Words types;
  bool is_type = true;
  for (std::string word; words >> word; is_type = word == "or") {
    if (is_type) types.insert(word);
  }
  return types;
}

/// Adds the names that a line "As above: `a`, `b`." tells, and what is in them.
void add_shared(const std::string& line, const Names& shared, Names& names) {
  std::istringstream parts(line.substr(0, line.find('.')));
  std::string part;
  for (bool is_code = false; std::getline(parts, part, '`'); is_code = !is_code) {
    for (const auto& [name, types] : shared) {
      if (is_code && (name == part || name.starts_with(part + "."))) names[name] = types;
    }
  }
}

/// The lists of the section "JSON", by subcommand; what several answers hold under "". A heading
/// "`sight --pairs`" goes on with the list of sight. Lines of a list are "- `name`: type, unit.
/// Meaning.".
std::map<std::string, Names> documented_names() {
  std::istringstream text(testing::read_file(PTIN_TEST_DATA "/../../tools/API.md"));
  std::map<std::string, Names> lists;
  std::string subcommand;
  bool within = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("## ")) within = line == "## JSON";
    if (!within) continue;
    if (line.starts_with("### ")) {
      const std::string code = first_code(line);
      subcommand = code.substr(0, code.find(' '));
    } else if (line.starts_with("As above: ")) {
      add_shared(line, lists[""], lists[subcommand]);
    } else if (const std::size_t type = line.find("`: "); line.starts_with("- `")) {
      EXPECT_NE(type, line.npos) << line;
      const std::size_t end = line.find_first_of(",.", type);
      lists[subcommand][first_code(line)] = types_in(line.substr(type + 3, end - type - 3));
    }
  }
  return lists;
}

std::string type_of(const json& value) {
  if (value.is_number_integer()) return "integer";
  return value.type_name();  // null, boolean, number, string, array, object
}

/// Every name of an object within `value`, but those of the source's metadata. Pairs of `sight`
/// hold what a single answer does, and the cost of their mesh what any cost does.
void add_names(const json& value, const std::string& path, Names& names) {
  if (value.is_array()) {
    for (const json& v : value) add_names(v, path + "[]", names);
  }
  if (!value.is_object()) return;
  const std::string prefix = path.empty() || path == "pairs[]" ? ""
                             : path == "base_cost"             ? "cost."
                                                               : path + ".";
  for (const auto& [name, v] : value.items()) {
    names[prefix + name].insert(type_of(v));
    if (name != "metadata") add_names(v, prefix + name, names);
  }
}

/// The types of `printed` that are none of `documented`; a whole number is a number, too.
Words other_types(const Words& printed, const Words& documented) {
  Words others;
  for (const std::string& type : printed) {
    const bool is_number = type == "integer" && documented.contains("number");
    if (!is_number && !documented.contains(type)) others.insert(type);
  }
  return others;
}

class JsonNames : public ::testing::Test {
 protected:
  JsonNames() {
    tools::testing::RasterRecipe recipe;
    recipe.nodata = -9999.0;
    recipe.value = [](int column, int row) {
      return column > 28 && row < 4 ? -9999.0 : tools::testing::hills(column, row);
    };
    tools::testing::make_raster(file("dem.tif"), recipe);
  }

  /// Runs `ptin ARGUMENTS --json` and notes the names of its answer.
  json ask(std::vector<std::string> arguments, int status = 0) {
    const std::string subcommand = arguments.front();
    arguments.emplace_back("--json");
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, status) << subcommand << ": " << outcome.err;
    json answer = json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(answer.is_object()) << subcommand << ": " << outcome.out;
    add_names(answer, "", printed[subcommand]);
    return answer;
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }

  TestFolder folder;
  std::map<std::string, Names> printed;
};

TEST_F(JsonNames, AreThoseOfTheLists) {
  const std::string store = file("dem.ptin");
  ask({"build", file("dem.tif"), "-o", store, "-q", "--title", "Hills", "--attribution", "Nobody",
       "--base-map", "https://h/{z}/{x}/{y}", "--base-map-attribution", "Somebody"});
  ask({"build", file("dem.tif"), "-o", file("none.ptin"), "-q", "--dry-run"});
  // Warnings of a text and of a raster have a line, a count or neither.
  tools::testing::write_file(file("odd.csv"), "x,y,z [smoot]\n0,0,1\n9,0,2\n0,9,3\n");
  ask({"build", file("odd.csv"), "-o", file("odd.ptin")});
  ask({"build", "--discard", "-o", file("none.ptin"), "-q"}, 1);
  ask({"build", file("dem.tif"), "-o", file("parts.ptin"), "-q", "--parts", "1", "--plan",
       file("plan")});
  ask({"build-part", file("plan"), "collapse", "0", "-q"});
  ask({"build-part", file("plan"), "join", "-q"});
  ask({"build-part", file("plan"), "tighten", "0", "-q"});
  ask({"build-part", file("plan"), "publish", "-q"});
  ask({"info", store});
  ask({"info", "/vsisubfile/0," + store});  // as a file that lies elsewhere
  ask({"verify", store, "-q", "--against", file("dem.tif"), "--tolerance", "0", "5"});
  tools::testing::write_file(file("cut.ptin"), tools::testing::read_file(store).substr(0, 30000));
  ask({"verify", file("cut.ptin"), "-q"}, 1);
  std::vector<json> questions;
  const auto question = [&](std::vector<std::string> arguments) {
    questions.push_back(ask(std::move(arguments)));
  };
  const std::string line = "LINESTRING(500100 3999900, 500700 3999300)";
  question({"refine", store, "--error", "2", "-o", file("a.ply")});
  question({"locate", store, "500100", "3999900"});
  question({"profile", store, "--line", line, "-o", file("a.csv")});
  question({"profile", store, "--line", line, "--stations", "50m"});
  question({"stream", store, "-o", file("a.pts")});
  question({"unstream", file("a.pts"), "-o", file("b.ply")});
  ask({"viewer", "-o", file("site"), "--stream", file("a.pts")});
  ask({"tiles", store, "-o", file("a.pmtiles"), "--zooms", "0", "4"});
  question({"isoline", store, "--interval", "20", "-o", file("a.geojson"), "-q"});
  question({"isoline", store, "--interval", "20", "--polygons", "-o", file("b.geojson"), "-q"});
  question(
      {"sight", store, "500100", "3999900", "2", "500700", "3999300", "2", "--frequency", "1e9"});
  question({"highest", store, "-k", "2"});
  question({"volume", store, "--level", "90"});
  question({"volume", store, "--against", store, "--error", "2"});
  const auto in_degrees = [&](const std::string& name, const std::string& shape) {
    tools::testing::write_file(file(name),
                               R"({"type":"Feature","properties":{},"geometry":)" + shape + "}");
    return file(name);
  };
  const std::string path = "[-116.998,36.137],[-116.992,36.137],[-116.992,36.142]";
  const std::string area = in_degrees(
      "area.geojson", R"({"type":"Polygon","coordinates":[[)" + path + ",[-116.998,36.137]]]}");
  question({"volume", store, "--level", "90", "--polygon", area, "-o", file("stages.csv")});
  question({"volume", store, "--level", "80", "90"});
  question({"highest", store, "--polygon", area});
  question({"isoline", store, "--level", "90", "-o", file("c.geojson"), "-q", "--polygon", area});
  question({"isoline", store, "--level", "90", "--polygons", "-o", file("d.geojson"), "-q",
            "--polygon", area});
  question({"export", store, "-o", file("part.ply"), "-q", "--polygon", area});
  question({"refine", store, "--polygon", area, "--cut", "-o", file("part.obj")});
  question({"profile", store, "--line",
            in_degrees("way.geojson", R"({"type":"LineString","coordinates":[)" + path + "]}")});
  question({"viewshed", store, "500500", "3999500", "2", "--radius", "300", "-o", file("a.tif")});
  question({"viewshed", store, "500500", "3999500", "2", "--radius", "300", "-o", file("a.gpkg")});
  question({"export", store, "-o", file("c.ply"), "-q"});
  question({"export", store, "-o", file("c.tif"), "--pixel-size", "30", "-q"});
  question({"export", store, "--what", "slope", "-o", file("slope.tif"), "-q"});
  question({"export", store, "-o", file("c.stl"), "-q"});
  question({"refine", store, "--error", "2", "-o", file("a.stl")});
  question({"unstream", file("a.pts"), "-o", file("b.stl")});
  question({"render", store, "-o", file("a.png"), "-q"});
  ask({"stream", store, "--window", "500100", "3999300", "500700", "3999900", "--error", "1",
       "--level", "90", "--splits", "40", "-o", file("d.pts")});
  ask({"unstream", file("d.pts")});
  ask({"unstream", file("a.pts"), "--interval", "20", "--steps", "-o", file("steps.geojson")});
  tools::testing::write_file(file("pairs.txt"),
                             "id x1 y1 h1 x2 y2 h2\n"
                             "A 500100 3999900 2 500700 3999300 2\n");
  ask({"sight", store, "--pairs", file("pairs.txt"), "-o", file("seen.geojson")});
  tools::testing::write_file(file("points.txt"), "id x y\nA 500100 3999900\n");
  ask({"locate", store, "--points", file("points.txt"), "-o", file("points.geojson")});
  ask({"profile", store, "--line", file("seen.geojson"), "--id", "id"});
  ask({"bench", store, "-q", "--count", "1", "--seconds", "4", "-o", file("bench.png")});
  ask({"completion", "bash"});

  std::map<std::string, Names> lists = documented_names();
  ASSERT_GT(lists.size(), 12u);
  for (const auto& [subcommand, names] : printed) {
    ASSERT_TRUE(lists.contains(subcommand)) << subcommand << " has no list";
    Names& documented = lists.at(subcommand);
    for (const auto& [name, types] : names) {
      EXPECT_TRUE(documented.contains(name)) << subcommand << " prints " << name;
      for (const std::string& type : other_types(types, documented[name])) {
        ADD_FAILURE() << subcommand << " prints " << name << " as " << type;
      }
    }
    for (const auto& [name, types] : documented) {
      EXPECT_TRUE(names.contains(name)) << subcommand << " never prints " << name;
    }
  }
  for (const json& answer : questions) {
    EXPECT_TRUE(answer.contains("units") && answer["units"].contains("height")) << answer.dump();
    EXPECT_EQ(answer["units"]["horizontal"], "metre") << answer.dump();
  }
}

}  // namespace
}  // namespace ptin::tools
