// SPDX-License-Identifier: GPL-3.0-or-later
//
// Areas as coverages, and what OGC's clients send.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tests/tools/serve_fixture.h"
#include "tools/facts/answers.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, GivesCoveragesWithOneMeaningOfNull) {
  const Window w = bounds_of(*coast_);
  const std::string ring = "POLYGON((" + text_of({w.min_x, w.min_y}) + "," +
                           text_of({w.max_x, w.min_y}) + "," + text_of({w.max_x, w.max_y}) + "," +
                           text_of({w.min_x, w.min_y}) + "))";
  const HttpAnswer answer =
      get(in("coast", "area?crs=native&resolution-x=20&resolution-y=10&coords=" + encoded(ring)));
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.header("content-type"), "application/prs.coverage+json");
  const json coverage = answer.json();
  const json& heights = coverage["ranges"]["height"];
  const json& states = coverage["ranges"]["state"]["values"];
  EXPECT_EQ(heights["shape"], (json{10, 20}));
  EXPECT_EQ(heights["values"].size(), 200U);
  EXPECT_EQ(coverage["domain"]["axes"]["x"]["num"], 20);
  std::set<int> seen;
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_EQ(heights["values"][i].is_null(), states[i] != 0) << i;
    seen.insert(states[i].get<int>());
  }
  EXPECT_TRUE(seen.count(0) != 0 && seen.count(3) != 0);
  // A height of the grid is the height at that position.
  const double x = w.min_x + (w.max_x - w.min_x) * 18 / 19,
               y = w.min_y + (w.max_y - w.min_y) * 1 / 9;
  const json point = get(in("coast", "position?crs=native&f=json&coords=" +
                                         encoded("POINT(" + text_of({x, y}) + ")")))
                         .json();
  EXPECT_EQ(heights["values"][1 * 20 + 18], point["points"][0]["height"]);
}

/// Looks whether exactly the positions of a coverage's grid that lie in a shape are told.
template <class Holds>
void expect_told_within(const json& coverage, const Holds& holds) {
  const json &x = coverage["domain"]["axes"]["x"], &y = coverage["domain"]["axes"]["y"];
  const auto at = [](const json& axis, int i) {
    const double first = axis["start"], last = axis["stop"];
    return first + (last - first) * i / (axis["num"].get<int>() - 1);
  };
  std::set<bool> seen;
  const json& states = coverage["ranges"]["state"]["values"];
  for (int row = 0, i = 0; row < y["num"]; ++row) {
    for (int column = 0; column < x["num"]; ++column, ++i) {
      const MapPoint p{at(x, column), at(y, row)};
      EXPECT_EQ(states[static_cast<std::size_t>(i)] != 3, holds(p)) << p.x << " " << p.y;
      seen.insert(holds(p));
    }
  }
  EXPECT_EQ(seen.size(), 2U);
}

TEST_F(Serve, GivesCubesRadiiAndCorridors) {
  const Window w = middle_of_bounds(*mountains_, 0.2);
  const std::string grid = "?crs=native&resolution-x=21&resolution-y=23";
  const json cube = get(in("mountains", "cube") + grid + "&bbox=" + window_text(w)).json();
  EXPECT_EQ(cube["ranges"]["height"]["shape"], (json{23, 21}));
  for (const json& state : cube["ranges"]["state"]["values"]) EXPECT_NE(state, 3);
  const double x = (w.min_x + w.max_x) / 2, y = (w.min_y + w.max_y) / 2;
  const std::string middle = encoded("POINT(" + text_of({x, y}) + ")");
  const std::string around = grid + "&within=0.4&within-units=KM&coords=" + middle;
  expect_told_within(get(in("mountains", "radius") + around).json(),
                     [&](MapPoint p) { return std::hypot(p.x - x, p.y - y) <= 400; });
  const std::string line =
      encoded("LINESTRING(" + text_of({x - 500, y}) + "," + text_of({x + 500, y}) + ")");
  expect_told_within(
      get(in("mountains", "corridor") + grid +
          "&corridor-width=300&width-units=m&corridor-height=1" + "&height-units=m&coords=" + line)
          .json(),
      [&](MapPoint p) {
        const double beyond = std::max(0.0, std::abs(p.x - x) - 500);
        return std::hypot(beyond, p.y - y) <= 150;
      });
  // A height is that at its position.
  const json one = get(in("mountains", "position?crs=native&f=json&coords=" + middle)).json();
  const json circle = get(in("mountains", "radius") + around).json();
  EXPECT_NEAR(circle["ranges"]["height"]["values"][11 * 21 + 10].get<double>(),
              one["points"][0]["height"].get<double>(), 1e-6);
  const json queries = get("/collections/mountains").json()["data_queries"];
  for (const char* query : {"cube", "radius", "corridor"}) {
    EXPECT_EQ(queries[query]["link"]["variables"]["query_type"], query);
  }
  EXPECT_EQ(queries["radius"]["link"]["variables"]["within_units"][0], "m");
  const auto refused = [&](const std::string& target, const char* parameter) {
    const HttpAnswer answer = get(in("mountains", target));
    EXPECT_EQ(answer.status, 400) << target << answer.body.substr(0, 200);
    EXPECT_EQ(answer.json().value("parameter", ""), parameter) << answer.body;
  };
  refused("cube?crs=native", "bbox");
  refused("radius?crs=native&within-units=m&coords=" + middle, "within");
  refused("radius?crs=native&within=1&coords=" + middle, "within-units");
  refused("radius?crs=native&within=1&within-units=parsec&coords=" + middle, "within-units");
  refused("radius?crs=native&within=-1&within-units=m&coords=" + middle, "within");
  refused("corridor?crs=native&corridor-width=1&width-units=m&coords=" + middle, "coords");
}

/// The number of positions along x and along y.
std::pair<int, int> sides_of(const json& coverage) {
  const json& shape = coverage["ranges"]["height"]["shape"];
  return {shape[1].get<int>(), shape[0].get<int>()};
}

TEST_F(Serve, CountsThePositionsOfAGrid) {
  const std::string area =
      in("mountains",
         "area?crs=native&coords=" + encoded("POLYGON((377000 3802000,381000 3802000,381000 "
                                             "3804000,377000 3804000,377000 3802000))"));
  using Sides = std::pair<int, int>;
  EXPECT_EQ(sides_of(get(area + "&resolution-x=5&resolution-y=7").json()), Sides(5, 7));
  EXPECT_EQ(sides_of(get(area + "&resolution-x=5").json()), Sides(5, 3));  // Squares of 1 km.
  EXPECT_EQ(sides_of(get(area + "&resolution-y=5").json()), Sides(9, 5));
  EXPECT_EQ(sides_of(get(area).json()), Sides(65, 33));
  EXPECT_EQ(sides_of(get(area + "&resolution-x=1&resolution-y=2").json()), Sides(1, 2));
  const json axes = get(area + "&resolution-x=5").json()["domain"]["axes"];
  EXPECT_EQ(axes["x"], json({{"start", 377000.0}, {"stop", 381000.0}, {"num", 5}}));
  const HttpAnswer many = get(area + "&resolution-x=20000&resolution-y=1");
  EXPECT_EQ(many.status, 413);
  EXPECT_EQ(many.json()["parameter"], "resolution-x");
}

TEST_F(Serve, GivesTheSamplesOfTheTerrainAsTheyAreStored) {
  const StoreFacts& facts = mountains_->store().facts();
  const AffineMap& map = facts.map;
  const MapPoint a = map.to_map(facts.bounds.min_x + 9.6, facts.bounds.min_y + 19.5);
  const MapPoint b = map.to_map(facts.bounds.min_x + 15.2, facts.bounds.min_y + 22.4);
  const std::string ring = "POLYGON((" + text_of(a) + "," + text_of({b.x, a.y}) + "," + text_of(b) +
                           "," + text_of({a.x, b.y}) + "," + text_of(a) + "))";
  const std::string area = in("mountains", "area?crs=native&coords=" + encoded(ring));
  for (const char* asked :
       {"&resolution-x=0&resolution-y=0", "&resolution-x=0", "&resolution-y=0"}) {
    const json coverage = get(area + asked).json();
    EXPECT_EQ(sides_of(coverage), std::pair(6, 3)) << asked;
    const MapPoint first = map.to_map(facts.bounds.min_x + 10, facts.bounds.min_y + 20);
    EXPECT_EQ(coverage["domain"]["axes"]["x"]["start"], first.x);
    EXPECT_EQ(coverage["domain"]["axes"]["y"]["start"], first.y);
    const std::vector<MapPoint> at{map.to_map(facts.bounds.min_x + 12, facts.bounds.min_y + 21)};
    EXPECT_EQ(coverage["ranges"]["height"]["values"][6 + 2],
              mountains_->locate(at, {}).points[0].height);
  }
  // In another CRS they are as near to each other.
  const std::string box =
      encoded("POLYGON((-118.31 34.35,-118.309 34.35,-118.309 34.351,-118.31 34.35))");
  const auto [columns, rows] =
      sides_of(get(in("mountains", "area?resolution-x=0&coords=" + box)).json());
  const double east = 1e-3 * 111320 * std::cos(34.35 * M_PI / 180) / map.step_x;
  EXPECT_NEAR(columns, east, 2);
  EXPECT_NEAR(rows, 1e-3 * 110922 / map.step_y, 2);
  EXPECT_EQ(get(in("mountains", "area?resolution-x=0&resolution-y=0&coords=" +
                                    encoded("POLYGON((-119 34,-118 34,-118 35,-119 34))")))
                .status,
            413);
}

TEST_F(Serve, TakesWhatOgcAndOthersClientsSend) {
  const std::string at = "POINT(-118.3%2034.34)";
  const json plain = get(in("mountains", "position?coords=" + at)).json();
  EXPECT_EQ(get(in("mountains", "position?datetime=2026-01-01&z=5&coords=" + at)).json(), plain);
  for (const char* wkt : {"POINTZ(-118.3 34.34 7)", "PointZM (-118.3 34.34 7 1)",
                          "POINT Z(-118.3 34.34 7)", "  point(-118.3 34.34) "}) {
    EXPECT_EQ(get(in("mountains", "position?coords=" + encoded(wkt))).json(), plain) << wkt;
  }
  EXPECT_EQ(get(in("mountains", "profile?coords=" +
                                    encoded("LINESTRINGZM(-118.3 34.34 1 2, -118.29 34.35 1 2)")))
                .status,
            200);
  const json two = get(in("mountains", "position?parameter-name=state,height&coords=" + at)).json();
  EXPECT_EQ(two["ranges"].size(), 2U);
  EXPECT_EQ(two["ranges"]["height"], plain["ranges"]["height"]);
  EXPECT_EQ(two["parameters"].size(), 2U);
  const json ids = plain["parameters"]["state"]["observedProperty"]["categories"];
  EXPECT_EQ(ids[2]["id"], name_of(PointState::kOutside));
  // The area's positions alone, as a position question has them.
  const std::string ring =
      encoded("POLYGON((-118.31 34.34,-118.3 34.34,-118.3 34.35,-118.31 34.34))");
  const std::string area = in("mountains", "area?resolution-x=4&resolution-y=4&coords=" + ring);
  const json features = get(area + "&f=geojson").json()["features"];
  const json coverage = get(area).json();
  std::size_t inner = 0;
  for (const json& state : coverage["ranges"]["state"]["values"]) inner += state == 3 ? 0 : 1;
  ASSERT_EQ(features.size(), inner);
  ASSERT_GT(inner, 3U);
  const json& first = features[0];
  const json& xy = first["geometry"]["coordinates"];
  const json same =
      get(in("mountains", "position?f=geojson&coords=" +
                              encoded("POINT(" + xy[0].dump() + " " + xy[1].dump() + ")")))
          .json();
  EXPECT_EQ(same["features"][0]["properties"], first["properties"]);
  const std::string csv = get(area + "&f=csv").body;
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), inner + 1);
  EXPECT_EQ(get("/collections/mountains").json()["parameter_names"].size(), 4U);
}

}  // namespace
}  // namespace ptin::tools::testing
