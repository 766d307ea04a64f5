// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table of JSON names in tools/API.md against what every subcommand prints: no name that the
// table does not have, none of the table that never comes, and the same words for the same things.
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
using Names = std::set<std::string>;

/// The names in the table's second column, by what is in its first.
std::map<std::string, Names> documented_names() {
  std::istringstream text(testing::read_file(PTIN_TEST_DATA "/../../tools/API.md"));
  std::map<std::string, Names> rows;
  bool within = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("## ")) within = line == "## JSON";
    const std::size_t middle = line.find(" | ");
    if (!within || !line.starts_with("| ") || middle == std::string::npos) continue;
    const auto words_in = [](const std::string& cell) {
      Names words;
      std::istringstream parts(cell);
      std::string part;
      for (bool is_code = false; std::getline(parts, part, '`'); is_code = !is_code) {
        if (is_code &&
            part.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == part.npos) {
          words.insert(part);
        }
      }
      return words;
    };
    const Names first = words_in(line.substr(0, middle));
    rows[first.empty() ? "every question" : *first.begin()] = words_in(line.substr(middle));
  }
  return rows;
}

/// Every name of an object within `value`, but those of the source's metadata.
void add_names(const json& value, Names& names) {
  if (value.is_array()) {
    for (const json& v : value) add_names(v, names);
  }
  if (!value.is_object()) return;
  for (const auto& [name, v] : value.items()) {
    names.insert(name);
    if (name != "metadata") add_names(v, names);
  }
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
    add_names(answer, printed[subcommand]);
    return answer;
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }

  TestFolder folder;
  std::map<std::string, Names> printed;
};

TEST_F(JsonNames, AreThoseOfTheTable) {
  const std::string store = file("dem.ptin");
  ask({"build", file("dem.tif"), "-o", store, "-q"});
  ask({"build", file("dem.tif"), "-o", file("none.ptin"), "-q", "--dry-run"});
  ask({"info", store});
  ask({"verify", store, "-q", "--against", file("dem.tif"), "--tolerance", "0", "5"});
  tools::testing::write_file(file("cut.ptin"), tools::testing::read_file(store).substr(0, 50000));
  ask({"verify", file("cut.ptin"), "-q"}, 1);
  std::vector<json> questions;
  const auto question = [&](std::vector<std::string> arguments) {
    questions.push_back(ask(std::move(arguments)));
  };
  const std::string line = "LINESTRING(500100 3999900, 500700 3999300)";
  question({"refine", store, "--error", "2", "-o", file("a.ply")});
  question({"locate", store, "500100", "3999900"});
  question({"profile", store, "--line", line, "-o", file("a.csv")});
  question({"stream", store, "-o", file("a.pts")});
  question({"unstream", file("a.pts"), "-o", file("b.ply")});
  question({"isoline", store, "--interval", "20", "-o", file("a.geojson"), "-q"});
  question({"isoline", store, "--interval", "20", "--polygons", "-o", file("b.geojson"), "-q"});
  question(
      {"sight", store, "500100", "3999900", "2", "500700", "3999300", "2", "--frequency", "1e9"});
  question({"highest", store, "-k", "2"});
  question({"viewshed", store, "500500", "3999500", "2", "--radius", "300", "-o", file("a.tif")});
  question({"viewshed", store, "500500", "3999500", "2", "--radius", "300", "-o", file("a.gpkg")});
  question({"export", store, "-o", file("c.ply"), "-q"});
  question({"export", store, "-o", file("c.tif"), "--pixel-size", "30", "-q"});
  question({"render", store, "-o", file("a.png"), "-q"});
  ask({"stream", store, "--window", "500100", "3999300", "500700", "3999900", "--error", "1",
       "--level", "90", "--splits", "40", "-o", file("d.pts")});
  ask({"unstream", file("d.pts")});
  ask({"unstream", file("a.pts"), "--interval", "20", "--steps", "-o", file("steps.geojson")});
  tools::testing::write_file(file("pairs.txt"), "500100 3999900 2 500700 3999300 2\n");
  ask({"sight", store, "--pairs", file("pairs.txt")});

  const std::map<std::string, Names> rows = documented_names();
  ASSERT_GT(rows.size(), 12u);
  for (const auto& [subcommand, names] : printed) {
    ASSERT_TRUE(rows.contains(subcommand)) << subcommand << " has no row";
    Names wanted = rows.at(subcommand);
    if (wanted.contains("cost") || wanted.contains("base_cost")) {
      wanted.merge(Names(rows.at("every question")));
      wanted.insert("cost");
    }
    if (wanted.contains("units")) wanted.insert({"horizontal", "height"});
    for (const std::string& name : names) {
      EXPECT_TRUE(wanted.contains(name)) << subcommand << " prints " << name;
    }
    for (const std::string& name : rows.at(subcommand)) {
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
