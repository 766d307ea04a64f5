// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin profile --stations: in every form of the answer, and in every unit.
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;

/// Hills of 30 m pixels, in a CRS of the given code.
class Stations : public ::testing::Test {
 protected:
  std::string built(int epsg, double west, double north, double pixel) const {
    testing::RasterRecipe recipe;
    recipe.epsg = epsg;
    recipe.west = west;
    recipe.north = north;
    recipe.pixel = pixel;
    recipe.value = testing::hills;
    const std::string name = folder_.file("hills_" + std::to_string(epsg));
    testing::make_raster(name + ".tif", recipe);
    expect_done({"build", name + ".tif", "-o", name + ".ptin", "-q"});
    return name + ".ptin";
  }
  /// Metres; the line is 500 m long.
  [[nodiscard]] std::string in_metres() const { return built(32611, 500000, 4000000, 30); }
  TestFolder folder_;
  std::string line_ = "LINESTRING(500100 3999900, 500400 3999500)";
};

/// The distances of the stations of an answer.
std::vector<double> distances_in(const json& answer) {
  std::vector<double> distances;
  for (const json& p : answer.at("points")) {
    if (p.at("station").get<bool>()) distances.push_back(p.at("distance"));
  }
  return distances;
}

TEST_F(Stations, StandBesideTheBreaksWhichStayAsTheyAre) {
  const std::string store = in_metres();
  const json breaks = answer_of({"profile", store, "--line", line_, "--json"});
  EXPECT_FALSE(breaks.at("points").at(0).contains("station"));
  const json all = answer_of({"profile", store, "--line", line_, "--stations", "120", "--json"});
  EXPECT_EQ(distances_in(all), (std::vector<double>{0, 120, 240, 360, 480, 500}));
  json others = all.at("points");
  for (std::size_t i = others.size(); i-- > 0;) {
    const bool is_inner = others[i].at("station").get<bool>() && i > 0 && i + 1 < others.size();
    others[i].erase("station");
    if (is_inner) others.erase(i);
  }
  EXPECT_EQ(others, breaks.at("points"));
  const json only = answer_of(
      {"profile", store, "--line", line_, "--stations", "120", "--stations-only", "--json"});
  EXPECT_EQ(only.at("points").size(), 6U);
  EXPECT_EQ(only.at("length"), 500.0);
}

TEST_F(Stations, HaveTheHeightsThatLocateTells) {
  const std::string store = in_metres();
  expect_done({"profile", store, "--line", line_, "--stations", "7", "--stations-only", "-o",
               folder_.file("s.csv")});
  const json stations = answer_of(
      {"profile", store, "--line", line_, "--stations", "7", "--stations-only", "--json"});
  const json located = answer_of({"locate", store, "--points", folder_.file("s.csv"), "--json"});
  ASSERT_EQ(located.at("points").size(), 73U);  // 500 / 7, both ends
  constexpr double kSpot = 30.0 / (1 << 22);    // what positions are exact to; slopes are below 100
  for (std::size_t i = 0; i < 73; ++i) {
    EXPECT_NEAR(located["points"][i]["height"].get<double>(),
                stations["points"][i]["height"].get<double>(), 100 * kSpot);
  }
}

TEST_F(Stations, AreToldInCsvAndLayers) {
  const std::string store = in_metres();
  const auto written = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"profile",    store, "--line", line_,
                                      "--stations", "200", "-o",     folder_.file(name)};
    words.insert(words.end(), more.begin(), more.end());
    expect_done(words);
    return read_file(folder_.file(name));
  };
  std::istringstream rows(written("all.csv", {}));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "distance,x,y,height,state,line,height_min,height_max,station");
  int stations = 0, breaks = 0;
  while (std::getline(rows, row)) (row.ends_with(",1") ? stations : breaks)++;
  EXPECT_EQ(stations, 4);
  EXPECT_GT(breaks, 10);
  EXPECT_EQ(testing::lines_in(written("only.csv", {"--stations-only"})), 5U);
  const json layer = json::parse(written("only.geojson", {"--stations-only"}));
  ASSERT_EQ(layer.at("features").size(), 4U);
  const json& last = layer.at("features").at(3);
  EXPECT_EQ(last.at("geometry").at("type"), "Point");
  EXPECT_EQ(last.at("geometry").at("coordinates").size(), 3U);
  EXPECT_EQ(last.at("properties").at("distance"), 500.0);
  EXPECT_EQ(last.at("properties").at("state"), "surface");
  const json lines = json::parse(written("all.geojson", {}));
  EXPECT_EQ(lines.at("features").at(0).at("geometry").at("type"), "MultiLineString");
}

TEST_F(Stations, TakeUnits) {
  const auto steps = [&](const std::string& store, const std::string& line,
                         const std::string& step) {
    return distances_in(
        answer_of({"profile", store, "--line", line, "--stations", step, "--json"}));
  };
  const std::string metres = in_metres();
  EXPECT_EQ(steps(metres, line_, "0.2km"), (std::vector<double>{0, 200, 400, 500}));
  EXPECT_NEAR(steps(metres, line_, "1000ft").at(1), 304.8, 1e-9);
  const std::string feet = built(2913, 7600000, 600000, 100);  // Oregon north, feet
  const std::string in_feet = "LINESTRING(7600200 599000, 7602200 599000)";
  EXPECT_NEAR(steps(feet, in_feet, "100m").at(1), 100 / 0.3048, 1e-6);
  EXPECT_NEAR(steps(feet, in_feet, "500").at(1), 500, 1e-9);
  const std::string degrees = built(4326, 10, 46, 0.001);
  const std::string in_degrees = "LINESTRING(10.002 45.98, 10.02 45.98)";
  EXPECT_NEAR(steps(degrees, in_degrees, "100m").at(1), 100, 1e-6);
  EXPECT_NEAR(steps(degrees, in_degrees, "100").at(1), 100, 1e-6);
}

TEST_F(Stations, AreRefusedWhereTheyMeanNothing) {
  const std::string store = in_metres();
  const auto refused = [&](const std::vector<std::string>& more, int status,
                           const std::string& said) {
    std::vector<std::string> words = {"profile", store, "--line", line_};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_ptin(words);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
  };
  for (const char* step : {"0", "-5", "nan", "inf", "5miles", "often", ""}) {
    refused({"--stations", step}, 2, "--stations");
  }
  refused({"--stations", "1e-6"}, 7, "500000002 stations");
  refused({"--stations", "1e-300"}, 7, "stations take");
  refused({"--stations-only"}, 2, "--stations");
  refused({"--stations", "10", "--stations-only", "-o", folder_.file("a.png")}, 2,
          "--stations-only");
}

}  // namespace
}  // namespace ptin::tools
