// SPDX-License-Identifier: GPL-3.0-or-later
//
// The isolines of a stream, as `ptin unstream --level` writes them, beside those of `ptin isoline`.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class StreamIsolinesCli : public ::testing::Test {
 protected:
  void build(const std::string& name) { (void)testing::built(folder, name, "t.ptin"); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
  json answer(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.emplace_back("--json");
    if (arguments.front() != "info") arguments.emplace_back("--overwrite");
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }
  TestFolder folder;
};

TEST_F(StreamIsolinesCli, AreInTheEndThoseOfTheTerrain) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    build(name);
    for (const std::vector<std::string>& error :
         {std::vector<std::string>{}, std::vector<std::string>{"--error", "5"}}) {
      const std::vector<std::string> levels = {"--level", "10", "1000", "1234.5"};
      std::vector<std::string> what = levels;
      what.insert(what.end(), error.begin(), error.end());
      const json sent = answer({"stream", file("t.ptin"), "-o", file("s.pts")}, what);
      const json all = answer({"stream", file("t.ptin"), "-o", file("all.pts")});
      EXPECT_LT(sent.at("splits"), all.at("splits"));
      const json got = answer({"unstream", file("s.pts"), "-o", file("u.geojson")}, levels);
      const json direct = answer({"isoline", file("t.ptin"), "-o", file("d.geojson")}, what);
      EXPECT_EQ(read_file(file("u.geojson")), read_file(file("d.geojson"))) << name;
      EXPECT_EQ(got.at("isolines").at("lines"), direct.at("lines"));
      EXPECT_GT(direct.at("lines"), 0);
      EXPECT_EQ(got.at("certified_error"), direct.at("certified_error"));
      const json& changed = got.at("isolines").at("changed");
      EXPECT_EQ(changed.at("splits"), sent.at("splits"));
      EXPECT_LT(changed.at("triangles"), 8 * sent.at("splits").get<int>());
    }
    std::filesystem::remove(file("t.ptin"));
  }
}

TEST_F(StreamIsolinesCli, StepsShowThemCome) {
  build("mountains_257.tif");
  const json sent = answer({"stream", file("t.ptin"), "--level", "1000", "-o", file("s.pts")});
  const json got = answer(
      {"unstream", file("s.pts"), "--level", "1000", "--steps", "-o", file("steps.geojson")});
  const json& steps = got.at("isolines").at("steps");
  // Head, start, T0 and end are no steps of their own; T0 is the first one.
  EXPECT_EQ(steps.size(), sent.at("frames").get<std::size_t>() - 2);
  EXPECT_EQ(steps.front().at("splits"), 0);
  EXPECT_EQ(steps.back().at("splits"), sent.at("splits"));
  const json layer = json::parse(read_file(file("steps.geojson")));
  std::size_t lines = 0;
  for (const json& step : steps) lines += step.at("lines").get<std::size_t>();
  EXPECT_EQ(layer.at("features").size(), lines);
  EXPECT_EQ(layer.at("features").back().at("properties").at("step"), steps.size() - 1);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_LE(steps[i].at("certified_error"), steps[i - 1].at("certified_error"));
  }
}

TEST_F(StreamIsolinesCli, StepsAreAsManyAsFramesOfSplitsHoweverSmallAndOverDeltas) {
  testing::RasterRecipe recipe;  // a plane: little to tell of a split
  recipe.value = [](int column, int row) { return column + 10.0 * row; };
  testing::make_raster(file("plane.tif"), recipe);
  answer({"build", file("plane.tif"), "-o", file("t.ptin")});
  const json few = answer({"stream", file("t.ptin"), "--splits", "3", "-o", file("a.pts")});
  const json rest =
      answer({"stream", file("t.ptin"), "--have",
              answer({"unstream", file("a.pts")}).at("have").dump(), "-o", file("b.pts")});
  ASSERT_GT(rest.at("splits"), 256);
  const json steps = answer({"unstream", file("a.pts"), file("b.pts"), "--level", "100", "--steps"})
                         .at("isolines")
                         .at("steps");
  // Start and end of a stream are no steps.
  EXPECT_EQ(steps.size(),
            few.at("frames").get<std::size_t>() - 2 + rest.at("frames").get<std::size_t>() - 2);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_GT(steps[i].at("splits"), steps[i - 1].at("splits"));
  }
}

TEST_F(StreamIsolinesCli, OfAWindowAreCutThereAndOfADeltaBeginAnew) {
  build("mountains_257.tif");
  const json b = answer({"info", file("t.ptin")}).at("bounds");
  const double x = b.at("min_x"), y = b.at("min_y"), w = b.at("max_x").get<double>() - x;
  const std::vector<std::string> window = {"--window", std::to_string(x + w / 4),
                                           std::to_string(y + w / 4), std::to_string(x + w / 2),
                                           std::to_string(y + w / 2)};
  answer({"stream", file("t.ptin"), "--level", "1000", "-o", file("a.pts")}, window);
  const json rest =
      answer({"stream", file("t.ptin"), "--level", "1000", "1100", "--have",
              answer({"unstream", file("a.pts")}).at("have").dump(), "-o", file("b.pts")});
  EXPECT_GT(rest.at("splits"), 0);
  answer({"unstream", file("a.pts"), "--level", "1000", "-o", file("u.geojson")}, window);
  answer({"isoline", file("t.ptin"), "--level", "1000", "-o", file("d.geojson")}, window);
  const json ours = json::parse(read_file(file("u.geojson")));
  const json direct = json::parse(read_file(file("d.geojson")));
  std::multiset<std::string> lines, wanted;
  for (const json& f : ours.at("features")) lines.insert(f.at("geometry").dump());
  for (const json& f : direct.at("features")) wanted.insert(f.at("geometry").dump());
  EXPECT_EQ(lines, wanted);
  EXPECT_FALSE(wanted.empty());
  answer({"unstream", file("a.pts"), file("b.pts"), "--level", "1000", "1100", "-o",
          file("u.geojson")});
  answer({"isoline", file("t.ptin"), "--level", "1000", "1100", "-o", file("d.geojson")});
  EXPECT_EQ(read_file(file("u.geojson")), read_file(file("d.geojson")));
}

TEST_F(StreamIsolinesCli, AreRefusedWhereTheyMeanNothing) {
  build("mountains_257.tif");
  answer({"stream", file("t.ptin"), "--error", "50", "-o", file("s.pts")});
  const auto refused = [&](const std::vector<std::string>& more, const char* word) {
    std::vector<std::string> arguments = {"unstream", file("s.pts")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << word;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  refused({"--steps"}, "--level");
  refused({"--level", "1000", "-o", file("x.ply")}, ".gpkg");
  refused({"--level", "1000", "-o", "-", "--json"}, "stdout");
  refused({"--interval", "1", "--base", "1e17"}, "2^53");
  refused({"--level", "nan", "-o", file("x.gpkg")}, "finite");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"s.pts", "t.ptin"}));
  // What the mesh leaves of --memory is for the isolines.
  const Outcome outcome = run_ptin(
      {"unstream", file("s.pts"), "--memory", "2M", "--interval", "0.1", "-o", file("x.gpkg")});
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(run_ptin({"unstream", file("s.pts"), "--memory", "2M", "-o", file("x.ply")}).status, 0);
}

}  // namespace
}  // namespace ptin::tools
