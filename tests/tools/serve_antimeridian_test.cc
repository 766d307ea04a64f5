// SPDX-License-Identifier: GPL-3.0-or-later
//
// Paths, lines, polygons and windows across the antimeridian, of terrains that end there: they go the
// shorter way around the Earth.
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

/// `north` reaches around the Earth from 2.5 to 87.5 degrees, `west` ends at 180 degrees, `mercator` in the plane of EPSG:3857 next to where x jumps, and `globe`
/// goes around the Earth from -177.5 to 177.5.
class ServeAntimeridian : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    serve::ServeOptions options;
    options.http = unhurried_limits();
    options.version = "test";
    const auto add = [&](const std::string& id, const RasterRecipe& recipe) {
      const std::string name = folder_->file(id);
      make_raster(name + ".tif", recipe);
      build_terrain(name + ".tif", name + ".ptin");
      options.files.push_back({id, name + ".ptin"});
    };
    RasterRecipe recipe;
    recipe.value = hills;
    recipe.epsg = 4326;
    recipe.pixel = 1.0 / 32;
    recipe.west = 179 - 1.0 / 64;
    recipe.north = 10.5;
    add("west", recipe);
    recipe.epsg = 3857;
    recipe.pixel = 1000;
    recipe.west = 20037508 - 33000;
    recipe.north = 1130000;
    add("mercator", recipe);
    recipe.epsg = 4326;
    recipe.pixel = 5;
    recipe.width = 72;
    recipe.west = -180;
    recipe.north = 82.5;
    add("globe", recipe);
    recipe.height = 18;
    recipe.north = 90;
    add("north", recipe);
    served_ = std::make_unique<ServedTerrains>(options);
  }
  static void TearDownTestSuite() {
    served_.reset();
    folder_.reset();
  }
  static HttpAnswer get(const std::string& target) {
    return served_->get("/collections/" + target);
  }
  static json points_along(const std::string& id, const std::string& line) {
    const HttpAnswer answer = get(id + "/profile?coords=" + encoded("LINESTRING(" + line + ")"));
    EXPECT_EQ(answer.status, 200) << answer.body;
    return answer.json()["points"];
  }
  static json height_at(const std::string& id, const std::string& place) {
    return get(id + "/position?f=json&coords=" + encoded("POINT(" + place + ")"))
        .json()["points"][0]["height"];
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::unique_ptr<ServedTerrains> served_;
};
std::unique_ptr<TestFolder> ServeAntimeridian::folder_;
std::unique_ptr<ServedTerrains> ServeAntimeridian::served_;

TEST_F(ServeAntimeridian, SamplesPathsTheShorterWay) {
  const json results =
      served_->get("/v1/west?samples=5&path=" + encoded("10,179.9|10,-179.9")).json()["results"];
  ASSERT_EQ(results.size(), 5U);
  const double expected[] = {179.9, 179.95, 180, 180.05, 180.1};
  for (std::size_t i = 0; i < 5; ++i) {
    const double lng = results[i]["location"]["lng"];
    EXPECT_LE(std::abs(lng), 180.0);
    EXPECT_NEAR(std::fmod(lng + 360, 360), expected[i], 1e-6);
    EXPECT_EQ(results[i]["state"], i < 3 ? "surface" : "outside");
  }
}

TEST_F(ServeAntimeridian, WalksLinesOffATerrainThatEndsThere) {
  for (const std::string id : {"west", "mercator"}) {
    SCOPED_TRACE(id);
    const json east = points_along(id, "179.9 10, -179.9 10");
    EXPECT_NEAR(east.back()["distance"].get<double>(), id == "west" ? 21928.4 : 22263.9, 1.0);
    EXPECT_EQ(east.front()["height"], height_at(id, "179.9 10"));
    EXPECT_EQ(east.front()["state"], "surface");
    EXPECT_EQ(east.back()["state"], "outside");
    EXPECT_NEAR(east.back()["x"].get<double>(), 180.1, 1e-9);
    const json west = points_along(id, "-179.9 10, 179.9 10");
    EXPECT_EQ(west.size(), east.size());
    EXPECT_NEAR(west.back()["height"].get<double>(), east.front()["height"].get<double>(), 1e-6);
    EXPECT_TRUE(west.front()["height"].is_null());
  }
}

TEST_F(ServeAntimeridian, WalksLinesOverBothEndsOfATerrainAroundTheEarth) {
  const json points = points_along("globe", "165 10, 175 12, -175 12, -165 10");
  double before = -1;
  for (const json& p : points) {
    EXPECT_GE(p["distance"].get<double>(), before);
    before = p["distance"];
    const double x = p["x"];
    EXPECT_TRUE(x >= 165 && x <= 195) << x;
    const bool is_between = x > 177.5 + 1e-9 && x < 182.5 - 1e-9;
    EXPECT_EQ(p["height"].is_null(), is_between) << p;
  }
  EXPECT_EQ(points.front()["height"], height_at("globe", "165 10"));
  EXPECT_NEAR(points.back()["height"].get<double>(), height_at("globe", "-165 10").get<double>(),
              1e-9);
  EXPECT_EQ(points.back()["state"], "surface");
  // Lines beside it are told under their own numbers, and stations from the beginning of each.
  const json both = get("globe/profile?stations=500000&coords=" +
                        encoded("MULTILINESTRING((175 0, -175 0), (0 0, 10 0), (-175 0, 175 0))"))
                        .json()["points"];
  std::vector<double> stations[3];
  for (const json& p : both) {
    if (p["station"]) stations[p["line"].get<std::size_t>()].push_back(p["distance"]);
  }
  for (const auto& line : stations) {
    ASSERT_EQ(line.size(), 4U);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(line[i], 5e5 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(line[3], 1113194.9, 0.1);
  }
}

TEST_F(ServeAntimeridian, LooksAlongLinesTheShorterWay) {
  const json pair =
      get("west/sight?coords=" + encoded("LINESTRING(179.9 10, -179.9 10)")).json()["pairs"][0];
  EXPECT_NEAR(pair["length"].get<double>(), 21928.4, 1.0);
  EXPECT_EQ(pair["ends"], json({"surface", "outside"}));
  const HttpAnswer both = get("globe/sight?coords=" + encoded("LINESTRING(170 0, -170 0)"));
  EXPECT_EQ(both.status, 400);
  EXPECT_EQ(both.json()["parameter"], "coords");
  EXPECT_EQ(get("globe/sight?coords=" + encoded("LINESTRING(170 0, 160 0)")).status, 200);
}

TEST_F(ServeAntimeridian, LaysGridsOverPolygonsTheShorterWay) {
  const std::string ring =
      encoded("POLYGON((179.9 9.9,-179.9 9.9,-179.9 10.1,179.9 10.1,179.9 9.9))");
  const std::string grid = "area?resolution-x=5&resolution-y=3&coords=" + ring;
  const json coverage = get("west/" + grid).json();
  EXPECT_NEAR(coverage["domain"]["axes"]["x"]["start"].get<double>(), 179.9, 1e-9);
  EXPECT_NEAR(coverage["domain"]["axes"]["x"]["stop"].get<double>(), 180.1, 1e-9);
  const json& states = coverage["ranges"]["state"]["values"];
  ASSERT_EQ(states.size(), 15U);
  for (std::size_t column = 0; column < 4; ++column) {
    EXPECT_EQ(states[5 + column], column < 3 ? 0 : 2) << column;
  }
  const json of_layer = get("west/" + grid + "&f=geojson").json();
  for (const json& feature : of_layer["features"]) {
    EXPECT_LE(std::abs(feature["geometry"]["coordinates"][0].get<double>()), 180.0);
  }
  const json of_globe = get("globe/area?resolution-x=5&resolution-y=3&coords=" +
                            encoded("POLYGON((170 0,-170 0,-170 10,170 10,170 0))"))
                            .json();
  for (const json& state : of_globe["ranges"]["state"]["values"]) {
    EXPECT_TRUE(state == 0 || state == 2 || state == 3);
  }
}

TEST_F(ServeAntimeridian, LaysGridsAroundAPole) {
  const json told =
      get("north/radius?within=500&within-units=km&resolution-x=73&resolution-y=5&coords=" +
          encoded("POINT(0 89)"))
          .json();
  const json &x = told["domain"]["axes"]["x"], &y = told["domain"]["axes"]["y"];
  EXPECT_EQ(x["start"], -180.0);
  EXPECT_EQ(x["stop"], 180.0);
  EXPECT_EQ(y["stop"], 90.0);
  const json& states = told["ranges"]["state"]["values"];
  const double south = y["start"];
  for (int row = 0; row < 5; ++row) {
    const double lat = south + (90 - south) * row / 4;
    for (int column = 0; column < 73; column += 9) {
      // On a sphere, away from where the ellipsoid decides.
      constexpr double kRadian = M_PI / 180;
      const double cosine = std::sin(89 * kRadian) * std::sin(lat * kRadian) +
                            std::cos(89 * kRadian) * std::cos(lat * kRadian) *
                                std::cos((-180 + 5 * column) * kRadian);
      const double km = 6371 * std::acos(std::min(1.0, cosine));
      if (std::abs(km - 500) < 10) continue;
      EXPECT_EQ(states[static_cast<std::size_t>(row * 73 + column)] == 3, km > 500)
          << lat << " " << column << " " << km;
    }
  }
}

TEST_F(ServeAntimeridian, TakesWindowsOnTheSideWhereTheTerrainIs) {
  for (const std::string id : {"west", "mercator"}) {
    const json across = get(id + "/highest?bbox=179.9,9.9,-179.9,10.1").json();
    EXPECT_EQ(across["features"], get(id + "/highest?bbox=179.9,9.9,180,10.1").json()["features"]);
    EXPECT_FALSE(across["features"].empty());
  }
  const HttpAnswer both = get("globe/highest?bbox=170,0,-170,10");
  EXPECT_EQ(both.status, 400);
  EXPECT_EQ(both.json()["parameter"], "bbox");
  EXPECT_EQ(get("globe/highest?bbox=-180,-90,180,90").status, 200);
  EXPECT_EQ(get("globe/highest?bbox=100,0,170,10").status, 200);
}

}  // namespace
}  // namespace ptin::tools::testing
