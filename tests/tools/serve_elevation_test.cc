// SPDX-License-Identifier: GPL-3.0-or-later
//
// `/v1`: heights as clients of Google's Elevation API and of opentopodata ask for them.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, AnswersElevationsToClientsOfOthers) {
  const json collection = get("/collections/mountains").json();
  const json box = collection["extent"]["spatial"]["bbox"][0];
  const double lon = (box[0].get<double>() + box[2].get<double>()) / 2;
  const double lat = (box[1].get<double>() + box[3].get<double>()) / 2;
  const std::string a = json(lat).dump() + "," + json(lon).dump();
  const std::string b = json(lat + 0.01).dump() + "," + json(lon + 0.01).dump();
  const json two =
      get("/v1/mountains?locations=" + a + encoded("|") + b + "&interpolation=cubic").json();
  ASSERT_EQ(two["results"].size(), 2U);
  const json posted = served_->post("/v1/mountains", {{"locations", a + "|" + b}}).json();
  EXPECT_EQ(posted, two);
  const json form =
      served_
          ->ask("POST", "/v1/mountains", "Content-Type: application/x-www-form-urlencoded\r\n",
                "locations=" + encoded(a + "|" + b))
          .json();
  EXPECT_EQ(form, two);
  const json path =
      get("/v1/mountains?path=" + a + encoded("|") + b + "&samples=3&key=secret").json();
  ASSERT_EQ(path["results"].size(), 3U);
  EXPECT_EQ(path["results"][0], two["results"][0]);
  EXPECT_EQ(path["results"][2], two["results"][1]);
  // Outside of every collection: null by default, and what was asked for.
  const json outside = get("/v1/mountains,coast?locations=10,10").json();
  EXPECT_TRUE(outside["results"][0]["elevation"].is_null());
  EXPECT_EQ(outside["results"][0]["state"], "outside");
  EXPECT_EQ(
      get("/v1/mountains?locations=10,10&nodata_value=-9999").json()["results"][0]["elevation"],
      -9999.0);
  const json places = {{"locations", "10,10"}, {"nodata_value", -0.5}};
  EXPECT_EQ(served_->post("/v1/mountains", places).json()["results"][0]["elevation"], -0.5);
  // The first one that has surface there answers.
  EXPECT_EQ(get("/v1/coast,mountains?locations=" + a).json()["results"][0]["dataset"], "mountains");
  // 38.5,-120.2 | 40.7,-120.95 | 43.252,-126.453: the example of the format's description.
  const json line =
      get("/v1/mountains?locations=" + encoded("enc:_p~iF~ps|U_ulLnnqC_mqNvxq`@")).json();
  ASSERT_EQ(line["results"].size(), 3U);
  EXPECT_NEAR(line["results"][2]["location"]["lat"].get<double>(), 43.252, 1e-9);
  EXPECT_NEAR(line["results"][2]["location"]["lng"].get<double>(), -126.453, 1e-9);
  EXPECT_EQ(get("/v1/mountains?locations=34.3").json()["status"], "INVALID_REQUEST");
  EXPECT_EQ(get("/v1/nobody?locations=34.3,1").json()["status"], "INVALID_REQUEST");
}

TEST_F(Serve, TakesPositionsAsArraysOfJsonAndASlashBehindTheName) {
  const json want = get("/v1/mountains?locations=" + encoded("34.34,-118.3|34.35,-118.29")).json();
  ASSERT_EQ(want["results"].size(), 2U);
  for (const json& locations :
       {json{{34.34, -118.3}, {34.35, -118.29}}, json{"34.34,-118.3", "34.35,-118.29"},
        json{{{"lat", 34.34}, {"lng", -118.3}}, {{"lat", 34.35}, {"lng", -118.29}}},
        json{{{"latitude", 34.34}, {"longitude", -118.3}},
             {{"latitude", 34.35}, {"longitude", -118.29}}}}) {
    EXPECT_EQ(served_->post("/v1/mountains", {{"locations", locations}}).json(), want) << locations;
    EXPECT_EQ(served_->post("/v1/mountains/", {{"locations", locations}}).json(), want);
  }
  for (const char* broken : {"[[34.34]]", "[[1,2,3]]", "[[91,0]]", "[{\"lat\":1}]",
                             "[[\"1\",\"2\"]]", "[1,2]", "[[null,1],[1,2]]", "[\"1;2\",\"1,2\"]"}) {
    const auto refused = served_->post("/v1/mountains", {{"locations", json::parse(broken)}});
    EXPECT_EQ(refused.status, 400) << broken;
    EXPECT_EQ(refused.json()["parameter"], "locations") << refused.body;
  }
  EXPECT_EQ(get("/v1/mountains/?locations=34.34,-118.3").json(),
            get("/v1/mountains?locations=34.34,-118.3").json());
  EXPECT_EQ(get("/v1/mountains,coast/?locations=10,10").status, 200);
  EXPECT_EQ(get("/v1/mountains//?locations=34.34,-118.3").status, 404);
  EXPECT_EQ(get("/v1/?locations=34.34,-118.3").status, 404);
}

TEST_F(Serve, AnswersOthersClientsInTheirForm) {
  const std::string at = "locations=34.34,-118.3";
  EXPECT_EQ(get("/v1/mountains?sensor=false&language=de&region=at&" + at).json()["status"], "OK");
  const HttpAnswer unknown = get("/v1/mountains,foo?" + at);
  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(unknown.json()["status"], "INVALID_REQUEST");
  EXPECT_TRUE(get("/v1/mountains?locations=10,10&nodata_value=NaN")
                  .json()["results"][0]["elevation"]
                  .is_null());
  // -118.3 and 34.34 as differences of 1e-5 degrees: to the bit what they are as text.
  std::string line;
  for (const int value : {3434000, -11830000}) {
    auto left = static_cast<unsigned>(value < 0 ? ~(value * 2) : value * 2);
    for (; left >= 32; left /= 32) line += static_cast<char>(63 + 32 + left % 32);
    line += static_cast<char>(63 + left);
  }
  const json location =
      get("/v1/mountains?locations=" + encoded("enc:" + line)).json()["results"][0]["location"];
  EXPECT_EQ(location["lat"], 34.34);
  EXPECT_EQ(location["lng"], -118.3);
}

}  // namespace
}  // namespace ptin::tools::testing
