// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights of all terrains at once, as clients of open-elevation and of Google ask for them.
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

/// `coarse`: 100 m everywhere, in pixels of 60 m. `fine`: 200 m in its north-west, in pixels of 30 m, with a
/// void in the middle. `lost`: without a CRS, finer than both.
class ServeLookup : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    serve::ServeOptions options;
    options.http = unhurried_limits();
    options.http.threads = 1;
    options.version = "test";
    const auto add = [&](const std::string& name, const RasterRecipe& recipe) {
      make_raster(folder_->file(name + ".tif"), recipe);
      build_terrain(folder_->file(name + ".tif"), folder_->file(name + ".ptin"));
      options.files.push_back({name, folder_->file(name + ".ptin")});
    };
    add("coarse", {.value = [](int, int) { return 100.0; }, .pixel = 60.0});
    add("fine",
        {.width = 17,
         .height = 17,
         .value = [](int x, int y) { return x > 5 && x < 11 && y > 5 && y < 11 ? -9999.0 : 200.0; },
         .nodata = -9999.0});
    add("lost", {.value = hills, .pixel = 1.0, .epsg = 0});
    served_ = std::make_unique<ServedTerrains>(options);
  }
  static void TearDownTestSuite() {
    served_.reset();
    folder_.reset();
  }
  static std::unique_ptr<TestFolder> folder_;
  static std::unique_ptr<ServedTerrains> served_;
};

std::unique_ptr<TestFolder> ServeLookup::folder_;
std::unique_ptr<ServedTerrains> ServeLookup::served_;

TEST_F(ServeLookup, AnswersFromTheFinestThatHasSurface) {
  // 100, 255 and 900 m to the east and to the south of the north-western corner.
  const std::string in_fine = "36.1438165,-116.9988884", in_void = "36.1424191,-116.9971656",
                    in_coarse = "36.1366035,-116.9899969";
  const json told = served_
                        ->get("/api/v1/lookup?locations=" +
                              encoded(in_fine + "|" + in_void + "|" + in_coarse + "|10,10"))
                        .json();
  ASSERT_EQ(told.at("results").size(), 4U) << told;
  EXPECT_EQ(told["results"][0]["elevation"], 200.0);
  EXPECT_EQ(told["results"][0]["dataset"], "fine");
  EXPECT_EQ(told["results"][1]["elevation"], 100.0);
  EXPECT_EQ(told["results"][1]["dataset"], "coarse");
  EXPECT_EQ(told["results"][2]["elevation"], 100.0);
  EXPECT_EQ(told["results"][3], json({{"latitude", 10.0},
                                      {"longitude", 10.0},
                                      {"elevation", nullptr},
                                      {"state", "outside"},
                                      {"dataset", nullptr}}));
  const json google = served_
                          ->get("/maps/api/elevation/json?key=k&locations=" +
                                encoded(in_fine + "|" + in_void + "|10,10"))
                          .json();
  EXPECT_EQ(google["status"], "OK");
  EXPECT_EQ(google["results"][0]["elevation"], 200.0);
  EXPECT_EQ(google["results"][1]["elevation"], 100.0);
  EXPECT_TRUE(google["results"][2]["elevation"].is_null());
  EXPECT_EQ(google["results"][2]["state"], "outside");
}

TEST_F(ServeLookup, TakesThePostOfOpenElevation) {
  const json body = {
      {"locations",
       {{{"latitude", 36.1428}, {"longitude", -116.999}}, {{"latitude", 10}, {"longitude", 10}}}}};
  const json posted = served_->post("/api/v1/lookup", body).json();
  EXPECT_EQ(posted, served_->get("/api/v1/lookup?locations=36.1428,-116.999%7C10,10").json());
  EXPECT_EQ(posted["results"][0]["elevation"], 200.0);
}

TEST_F(ServeLookup, SaysWhatIsWrong) {
  for (const char* query : {"", "?locations=", "?locations=1", "?locations=91,0", "?f=json",
                            "?locations=1,2&error=-1"}) {
    const HttpAnswer refused = served_->get(std::string("/api/v1/lookup") + query);
    EXPECT_EQ(refused.status, 400) << query;
    EXPECT_FALSE(refused.json().at("error").get<std::string>().empty()) << refused.body;
  }
  // An array of JSON is no encoded polyline, though its text may be one.
  for (const json& locations :
       {json::array(), json{json::array()}, json{json::object()}, json(1)}) {
    const HttpAnswer refused = served_->post("/api/v1/lookup", {{"locations", locations}});
    EXPECT_EQ(refused.status, 400) << locations << refused.body;
  }
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"lost", folder_->file("lost.ptin")}};
  ServedTerrains lost(options);
  const HttpAnswer refused = lost.get("/api/v1/lookup?locations=1,2");
  EXPECT_EQ(refused.status, 404);
  EXPECT_NE(refused.json().at("error").get<std::string>().find("CRS"), std::string::npos);
}

}  // namespace
}  // namespace ptin::tools::testing
