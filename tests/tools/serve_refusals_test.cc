// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is refused, with the parameter at fault or the limit gone beyond.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, NamesTheParameterAtFault) {
  const struct {
    const char* target;
    int status;
    const char* parameter;
  } all[] = {
      {"position", 400, "coords"},
      {"position?coords=POINT(nan%201)", 400, "coords"},
      {"position?coords=LINESTRING(0%200,1%201)", 400, "coords"},
      {"position?coords=POINT(0%200)&crs=EPSG:99999999", 400, "crs"},
      {"position?coords=POINT(0%200)&error=-1", 400, "error"},
      {"position?coords=POINT(0%200)&error=inf", 400, "error"},
      {"position?coords=POINT(0%200)&error=1&vertices=9", 400, "vertices"},
      {"position?coords=POINT(0%200)&colour=red", 400, "colour"},
      {"position?coords=POINT(0%200)&f=xml", 400, "f"},
      {"position?coords=POINT(0%200)&coords=POINT(0%200)", 400, "coords"},
      {"isolines", 400, "interval"},
      {"isolines?interval=0", 400, "interval"},
      {"isolines?interval=0.0001", 413, "interval"},
      {"isolines?interval=100&bbox=1,2,3", 400, "bbox"},
      {"isolines?interval=100&bbox=3,2,1,4", 400, "bbox"},
      {"mesh?vertices=9999999", 413, "vertices"},
      {"viewshed?coords=POINT(-118.3%2034.34)", 400, "radius"},
      {"sight", 400, "coords"},
      {"sight?coords=LINESTRING(0%200,1%201)&heights=1", 400, "heights"},
      {"sight?pairs=[[1,2]]", 400, "pairs"},
      {"stream?max_bytes=99999999", 413, "max_bytes"},
      {"stream?error=1&fingerprint=0", 409, "fingerprint"},
      {"mesh?bbox=1,2,3,4", 400, "bbox"},
      {"mesh?vertices=1", 400, "vertices"},
      {"viewshed?coords=POINT(-118.3%2034.34)&radius=0", 400, "radius"},
      {"viewshed?coords=POINT(-110%2034.34)&radius=500", 400, "coords"},
      {"mesh?bbox=10,2,-10,4&crs=native", 400, "bbox"},
      {"mesh?bbox=100,2,-100,4&crs=native", 400, "bbox"},
      {"position?coords=POINT(-118.3%2034.34)garbage", 400, "coords"},
      {"position?coords=POINT(-118.3%2034.34)&parameter-name=height,foo", 400, "parameter-name"},
      {"area?coords=POLYGON((0%200,1%200,1%201,0%200))&parameter-name=foo", 400, "parameter-name"},
      {"profile?coords=LINESTRING(0%200,0%200)", 400, "coords"},
      {"profile?coords=LINESTRING(-118.3%2034.34,-118.29%2034.35)&stations=1e-9", 413, "stations"},
      {"stream?have=5", 400, "have"},
      {"highest?listed=-1", 400, "listed"},
  };
  for (const auto& one : all) {
    const HttpAnswer answer = get(in("mountains", one.target));
    EXPECT_EQ(answer.status, one.status) << one.target << "\n" << answer.body;
    EXPECT_EQ(answer.header("content-type"), "application/problem+json") << one.target;
    EXPECT_EQ(answer.json().value("parameter", ""), one.parameter) << one.target << answer.body;
    EXPECT_FALSE(answer.json()["detail"].get<std::string>().empty());
  }
  EXPECT_EQ(get("/nothing").status, 404);
  EXPECT_EQ(get("/collections/nobody/position?coords=POINT(0%200)").json()["parameter"], "id");
  EXPECT_EQ(served_->ask("DELETE", "/collections", "", "").status, 405);
  EXPECT_EQ(served_->ask("POST", in("mountains", "mesh"), "", "{}").status, 405);
  EXPECT_EQ(served_->ask("POST", in("mountains", "position"), "Content-Type: text/xml\r\n", "<a/>")
                .status,
            415);
  const std::string deep(40, '[');
  const json too_deep = served_
                            ->ask("POST", in("mountains", "stream"), "",
                                  "{\"have\":" + deep + std::string(40, ']') + "}")
                            .json();
  EXPECT_EQ(too_deep["status"], 400);
  EXPECT_EQ(too_deep["parameter"], "body");
  EXPECT_NE(too_deep["detail"].get<std::string>().find("deeper than 16"), std::string::npos);
  EXPECT_FALSE(too_deep.contains("limit"));  // It is no option.
}

TEST_F(Serve, RefusesMembersThatComeTwice) {
  const HttpAnswer answer =
      served_->ask("POST", in("mountains", "position"), "Content-Type: application/json\r\n",
                   R"json({"coords":"POINT(-118.3 34.34)","coords":"POINT(0 0)"})json");
  EXPECT_EQ(answer.status, 400);
  EXPECT_NE(answer.body.find("twice"), std::string::npos) << answer.body;
}

/// Answers that take more than a small question's memory are refused, and the service goes on.
TEST(ServeSmall, KeepsMeshesAndListsWithinTheMemoryOfAQuestion) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = 8 << 20;
  ServedTerrains served(options);
  const std::string mountains = "/collections/mountains/";
  for (const char* question :
       {"mesh", "mesh?f=ply", "viewshed?f=geojson&radius=5000&coords=POINT(-118.3%2034.34)"}) {
    const HttpAnswer answer = served.get(mountains + question);
    EXPECT_EQ(answer.status, 413) << question << " " << answer.body.size();
    EXPECT_EQ(answer.json().value("limit", ""), "question_memory") << question;
  }
  EXPECT_EQ(served.get(mountains + "mesh?error=20").status, 200);
}

TEST_F(ServeElsewhere, KeepsLongAnswersWithinTheMemoryOfAQuestion) {
  std::string line = "LINESTRING(";
  for (int i = 0; i < 300; ++i) {
    line += i == 0 ? "" : ",";
    line += std::to_string(400000 + 30 * i) + " " + std::to_string(i % 2 == 0 ? 399900 : 390600);
  }
  const std::string target =
      "austria/profile?crs=native&stations=200&coords=" + encoded(line + ")");
  for (const char* format : {"&f=json", "&f=geojson", "&f=csv"}) {
    const HttpAnswer answer = get(target + format);
    EXPECT_EQ(answer.status, 413) << format << " " << answer.body.size();
    EXPECT_EQ(answer.json()["limit"], "question_memory");
  }
  std::string ring = "POLYGON((";
  for (int i = 0; i < 10001; ++i) ring += std::to_string(i % 2) + " " + std::to_string(i % 3) + ",";
  const HttpAnswer corners =
      served_->post("/collections/austria/area", {{"coords", ring + "0 0))"}, {"crs", "native"}});
  EXPECT_EQ(corners.status, 413);
  EXPECT_EQ(corners.json()["limit"], "points");
}

}  // namespace
}  // namespace ptin::tools::testing
