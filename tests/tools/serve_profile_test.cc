// SPDX-License-Identifier: GPL-3.0-or-later
//
// Profiles and trajectories, in the units of the command line.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/ground.h"
#include "engine/query/questions.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, WalksLinesAsTheLibraryDoes) {
  const Window w = bounds_of(*mountains_);
  const std::vector<MapPoint> line = {{w.min_x + 100, w.min_y + 100},
                                      {w.max_x - 77, w.max_y - 333}};
  ProfileRequest request;
  request.ground_distance = ground_of(crs_facts(mountains_->store())).distance;
  request.station_step = 500;
  request.detail.tolerance = 10;
  const ProfileResult expected = mountains_->profile(line, request);
  const std::string coords =
      encoded("LINESTRING(" + text_of(line[0]) + "," + text_of(line[1]) + ")");
  const json told =
      get(in("mountains", "profile?crs=native&stations=500&error=10&coords=" + coords)).json();
  ASSERT_EQ(told["points"].size(), expected.points.size());
  for (std::size_t i = 0; i < expected.points.size(); ++i) {
    expect_number(told["points"][i]["distance"], expected.points[i].distance);
    expect_number(told["points"][i]["height"], expected.points[i].height);
    EXPECT_EQ(told["points"][i]["station"], expected.points[i].is_station);
  }
  const json coverage =
      get(in("mountains", "trajectory?crs=native&error=10&coords=" + coords)).json();
  EXPECT_EQ(coverage["domain"]["domainType"], "MultiPoint");
  const std::string csv = get(in("mountains", "profile?crs=native&f=csv&coords=" + coords)).body;
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "line,distance,x,y,height,state,station");
}

TEST_F(ServeElsewhere, MeasuresAsTheCommandLineDoes) {
  const std::string feet = "LINESTRING(600100 3999900, 600700 3999400)";
  const std::string degrees = "LINESTRING(179.96 10.04, 180.04 9.96)";
  for (const auto& [file, line] : {std::pair{files_[0], feet}, {files_[1], degrees}}) {
    const json expected =
        answer_of({"profile", file.path, "--line", line, "--stations", "100", "--json"});
    const json told =
        get(file.id + "/profile?crs=native&stations=100&coords=" + encoded(line)).json();
    EXPECT_EQ(told["points"], expected["points"]);
    EXPECT_EQ(told["length_unit"], expected["units"]["length"]);
    EXPECT_EQ(told["unit"], "foot");
  }
  // Metres in and out, where the file has feet.
  const json box = get("feet").json()["extent"]["spatial"]["bbox"][0];
  const std::string at = json((box[1].get<double>() + box[3].get<double>()) / 2).dump() + "," +
                         json((box[0].get<double>() + box[2].get<double>()) / 2).dump();
  const HttpAnswer told = served_->get("/v1/feet?error=1&locations=" + at);
  EXPECT_EQ(told.status, 200) << told.body;
  EXPECT_NEAR(std::stod(told.header("ptin-certified-error")), 1.0, 1e-9);
  EXPECT_NEAR(told.json()["certified_error"].get<double>(), 1.0, 1e-9);
}

}  // namespace
}  // namespace ptin::tools::testing
