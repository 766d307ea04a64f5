// SPDX-License-Identifier: GPL-3.0-or-later
//
// Degrees over a terrain for clients without projections, against PROJ.
#include "tools/serve/lon_lat_nodes.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"
#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;
using serve::lon_lat_nodes;
using serve::LonLatNodes;

CrsFacts facts_of_code(const std::string& code) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.SetFromUserInput(code.c_str()), OGRERR_NONE);
  char* text = nullptr;
  crs.exportToWkt(&text);
  CrsFacts facts = crs_facts(text);
  CPLFree(text);
  return facts;
}

/// The most that the nodes are off at 31 x 31 places, degrees; both ends of the window are among them.
double found_off(const LonLatNodes& nodes, const Window& w, const CrsFacts& crs) {
  const Transformed to_globe(crs.wkt, "OGC:CRS84");
  double off = 0;
  for (int i = 0; i < 31 * 31; ++i) {
    const double x = i % 31 / 30.0, y = i / 31 / 30.0;
    const MapPoint told = nodes.at(x, y);
    const Ecef is = to_globe({std::lerp(w.min_x, w.max_x, x), std::lerp(w.min_y, w.max_y, y), 0});
    const double lon = std::remainder(told.x - is[0], 360.0);
    off = std::max({off, std::abs(lon), std::abs(told.y - is[1])});
  }
  return off;
}

TEST(LonLatNodes, AreOffByNoMoreThanTheySay) {
  struct Case {
    const char* code;
    Window window;
    double most;  ///< Degrees that `within` may be.
  };
  for (const Case& c : {Case{"EPSG:32611", {379900, 3784000, 415900, 3803400}, 1e-8},
                        Case{"EPSG:32633", {300000, 5000000, 400000, 5100000}, 1e-7},
                        Case{"EPSG:2154", {100000, 6100000, 1200000, 7100000}, 2e-3},
                        Case{"EPSG:27700", {500000, 150000, 560000, 210000}, 1e-5},
                        Case{"EPSG:3857", {-2e5, 5e6, 2e5, 5.4e6}, 1e-5},
                        Case{"EPSG:3832", {3.3e6, -1e5, 3.4e6, 1e5}, 1e-5},  // 180 degrees east
                        Case{"EPSG:3413", {-3e5, -2.2e6, 2e5, -1.9e6}, 5e-3}}) {
    const CrsFacts crs = facts_of_code(c.code);
    const auto nodes = lon_lat_nodes(c.window, crs);
    ASSERT_TRUE(nodes) << c.code;
    EXPECT_LE(found_off(*nodes, c.window, crs), nodes->within) << c.code;
    EXPECT_LE(nodes->within, c.most) << c.code;
  }
}

TEST(LonLatNodes, AreNotThereWhereNobodyShouldTrustThem) {
  EXPECT_FALSE(lon_lat_nodes({0, 0, 1, 1}, CrsFacts{})) << "no CRS";
  EXPECT_FALSE(lon_lat_nodes({8, 46, 9, 47}, facts_of_code("EPSG:4326"))) << "it has degrees";
  EXPECT_FALSE(lon_lat_nodes({-1e6, -1e6, 1e6, 1e6}, facts_of_code("EPSG:3413"))) << "a pole";
  EXPECT_FALSE(lon_lat_nodes({1e9, 1e9, 2e9, 2e9}, facts_of_code("EPSG:32633"))) << "nowhere";
}

TEST_F(Serve, TellsDegreesOverAProjectedTerrain) {
  const json told = get("/collections/mountains").json()["terrain"];
  ASSERT_EQ(told["lon_lat"]["nodes"].size(), 16U);
  EXPECT_LE(told["lon_lat"]["within"], 1e-8);
  // The second node of the second row is where the service finds the place a third of the way.
  const json node = told["lon_lat"]["nodes"][5], bounds = told["bounds"];
  const auto height_at = [&](double x, double y, const std::string& crs) {
    std::ostringstream coords;
    coords << std::setprecision(15) << x << "%20" << y;
    const json found =
        get(in("mountains", "position?f=json&coords=POINT(" + coords.str() + ")" + crs)).json();
    return found.at("points").at(0).at("height").get<double>();
  };
  const double x = std::lerp(bounds[0].get<double>(), bounds[2].get<double>(), 1 / 3.0);
  const double y = std::lerp(bounds[1].get<double>(), bounds[3].get<double>(), 1 / 3.0);
  EXPECT_NEAR(height_at(node[0], node[1], ""), height_at(x, y, "&crs=native"), 0.01);
}

}  // namespace
}  // namespace ptin::tools::testing
