// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight, the highest point and what is seen from it.
#include <cstddef>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/ground.h"
#include "engine/query/questions.h"
#include "tests/tools/serve_fixture.h"
#include "tools/facts/answers.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, DecidesLinesOfSightAsTheLibraryDoes) {
  std::mt19937_64 random(7);
  const Ground ground = ground_of(crs_facts(mountains_->store()));
  SightRequest request;
  request.curvature = {Curvature{}.coefficient, ground.earth_diameter};
  request.ground_distance = ground.distance;
  json pairs = json::array();
  std::vector<SightPair> all;
  for (int i = 0; i < 50; ++i) {
    const MapPoint a = some_place(*mountains_, random), b = some_place(*mountains_, random);
    all.push_back({a, 2.0, b, 30.0});
    pairs.push_back({a.x, a.y, 2.0, b.x, b.y, 30.0});
  }
  const json told =
      served_->post(in("mountains", "sight"), {{"crs", "native"}, {"pairs", pairs}}).json();
  ASSERT_EQ(told["pairs"].size(), all.size()) << told;
  SightSolver solver = mountains_->sight_lines(request, SightSolver::kCoarseRecords);
  std::set<std::string> verdicts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const SightResult expected = solver.solve(all[i]);
    // As the command line: null where an end has no ground that it is above.
    const bool is_defined = expected.verdict != SightVerdict::kUndefined;
    EXPECT_EQ(told["pairs"][i]["verdict"], is_defined ? json(name_of(expected.verdict)) : json());
    verdicts.insert(name_of(expected.verdict));
    if (expected.clearance_at) {
      expect_number(told["pairs"][i]["clearance"]["min"], expected.clearance_min);
    }
  }
  EXPECT_GE(verdicts.size(), 2U);
}

TEST_F(Serve, TellsHowCertainLinesOfSightAre) {
  const std::string ends =
      "coords=" + encoded("LINESTRING(-118.3 34.34, -118.29 34.35)") + "&heights=2,2";
  const HttpAnswer exact = get(in("mountains", "sight?" + ends));
  EXPECT_EQ(exact.header("ptin-certified-error"), "0");
  EXPECT_EQ(exact.json()["certified_error"], 0.0);
  const HttpAnswer coarse = get(in("mountains", "sight?error=5&" + ends));
  EXPECT_EQ(coarse.header("ptin-certified-error"), "5");
  EXPECT_EQ(coarse.json()["certified_error"], 5.0);
  EXPECT_EQ(coarse.json()["exact"].dump(), coarse.header("ptin-exact"));
}

TEST_F(Serve, FindsTheHighestPointAndWhatIsSeenFromIt) {
  const HighestResult expected = mountains_->highest({});
  const json told = get(in("mountains", "highest?crs=native&listed=3")).json();
  EXPECT_EQ(told["features"].size(), 3U);
  const json& top = told["features"][0];
  expect_number(top["properties"]["height"], expected.point.height);
  const MapPoint eye{top["geometry"]["coordinates"][0].get<double>(),
                     top["geometry"]["coordinates"][1].get<double>()};
  const std::string coords = encoded("POINT(" + text_of(eye) + ")");
  const HttpAnswer png = get(in("mountains", "viewshed?crs=native&radius=1500&coords=" + coords));
  EXPECT_EQ(png.header("content-type"), "image/png");
  EXPECT_EQ(png.body.substr(1, 3), "PNG");
  ViewshedRequest request;
  request.eye = eye;
  request.eye_height = 2.0;
  request.radius = 1500;
  request.curvature = {Curvature{}.coefficient,
                       ground_of(crs_facts(mountains_->store())).earth_diameter};
  const Viewshed seen = mountains_->viewshed(request);
  const json points =
      get(in("mountains", "viewshed?crs=native&f=geojson&radius=1500&coords=" + coords)).json();
  EXPECT_EQ(points["visible"], seen.visible_vertices);
  EXPECT_EQ(points["features"].size(), seen.vertices.size());
}

}  // namespace
}  // namespace ptin::tools::testing
