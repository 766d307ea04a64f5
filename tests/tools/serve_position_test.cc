// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at positions, and in which order a position's numbers come.
#include <cstddef>
#include <random>
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

TEST_F(Serve, TellsHeightsAsTheLibraryDoes) {
  std::mt19937_64 random(20261123);
  for (const auto& [id, terrain] :
       {std::pair{"mountains", mountains_.get()}, {"coast", coast_.get()}}) {
    for (const char* level : {"", "&error=5", "&vertices=500"}) {
      std::vector<MapPoint> places;
      std::string wkt = "MULTIPOINT(";
      for (int i = 0; i < 40; ++i) {
        places.push_back(some_place(*terrain, random));
        wkt += (i == 0 ? "(" : ",(") + text_of(places.back()) + ")";
      }
      LocateRequest request;
      if (std::string(level) == "&error=5") request.detail.tolerance = 5.0;
      if (std::string(level) == "&vertices=500") request.detail.vertices = 500;
      const LocateResult expected = terrain->locate(places, request);
      const HttpAnswer answer =
          get(in(id, "position?crs=native&f=json&coords=" + encoded(wkt + ")") + level));
      ASSERT_EQ(answer.status, 200) << answer.body;
      const json told = answer.json();
      EXPECT_EQ(told["exact"], expected.exact);
      expect_number(told["certified_error"], expected.certified_error);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const json& p = told["points"][i];
        EXPECT_EQ(p["state"], name_of(expected.points[i].state));
        expect_number(p["height"], expected.points[i].height);
        expect_number(p["height_min"], expected.points[i].height_min);
        expect_number(p["height_max"], expected.points[i].height_max);
      }
    }
  }
}

TEST_F(Serve, TakesLongitudeBeforeLatitudeInWktAndAfterItInLocations) {
  const json collection = get("/collections/mountains").json();
  const json box = collection["extent"]["spatial"]["bbox"][0];
  const double lon = (box[0].get<double>() + box[2].get<double>()) / 2;
  const double lat = (box[1].get<double>() + box[3].get<double>()) / 2;
  const std::string x = json(lon).dump(), y = json(lat).dump();
  const json point =
      get(in("mountains", "position?f=json&coords=" + encoded("POINT(" + x + " " + y + ")")))
          .json();
  const json elevation = get("/v1/mountains?locations=" + y + "," + x).json();
  EXPECT_EQ(point["points"][0]["state"], "surface");
  EXPECT_EQ(elevation["status"], "OK");
  EXPECT_EQ(elevation["results"][0]["location"]["lat"], lat);
  EXPECT_EQ(elevation["results"][0]["location"]["lng"], lon);
  EXPECT_EQ(elevation["results"][0]["elevation"], point["points"][0]["height"]);
  const json swapped = get("/v1/mountains?locations=" + x + "," + y).json();
  EXPECT_EQ(swapped["status"], "INVALID_REQUEST");
}

TEST_F(ServeElsewhere, NamesAxesInTheOrderOfTheAuthority) {
  const json swapped = {"y", "x"}, plain = {"x", "y"};
  const auto axes = [](const std::string& target) {
    return get(target).json()["domain"]["referencing"][0]["coordinates"];
  };
  const std::string at = "/position?coords=POINT(1%202)";
  EXPECT_EQ(axes("degrees" + at + "&crs=native"), swapped);
  EXPECT_EQ(axes("austria" + at + "&crs=native"), swapped);
  EXPECT_EQ(axes("degrees" + at + "&crs=EPSG:4326"), swapped);
  EXPECT_EQ(axes("degrees" + at), plain);
  EXPECT_EQ(axes("metres" + at + "&crs=native"), plain);
}

}  // namespace
}  // namespace ptin::tools::testing
