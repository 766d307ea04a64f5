// SPDX-License-Identifier: GPL-3.0-or-later
//
// The collections, their extent, their files, and the service's load.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"
#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, ListsItsCollectionsAndItsLoad) {
  const json collections = get("/collections").json();
  ASSERT_EQ(collections["collections"].size(), 2U);
  EXPECT_EQ(collections["collections"][0]["id"], "coast");
  EXPECT_TRUE(collections["collections"][0]["links"].is_array());
  EXPECT_EQ(get("/healthz").body, "alive\n");
  EXPECT_EQ(get("/readyz").body, "ready\n");
  const std::string metrics = get("/metrics").body;
  EXPECT_NE(metrics.find("ptin_requests_total{question=\"collections\",status=\"200\"}"),
            std::string::npos);
  EXPECT_NE(metrics.find("# TYPE ptin_compute_seconds histogram"), std::string::npos);
  EXPECT_EQ(metrics.find("coords"), std::string::npos);
  const HttpAnswer cross =
      served_->ask("OPTIONS", in("mountains", "stream"),
                   "Origin: http://a\r\nAccess-Control-Request-Method: POST\r\n", "");
  EXPECT_EQ(cross.status, 204);
  EXPECT_EQ(cross.header("access-control-allow-origin"), "*");
}

TEST_F(ServeElsewhere, ReachesAcrossTheAntimeridian) {
  for (const std::string id : {"degrees", "metres"}) {
    const json box = get(id).json()["extent"]["spatial"]["bbox"][0];
    EXPECT_GT(box[0].get<double>(), 179.9) << box;
    EXPECT_LT(box[2].get<double>(), -179.9) << box;
    const json east = get(id + "/position?f=json&coords=POINT(-179.99%2010)").json();
    EXPECT_EQ(east["points"][0]["state"], "surface") << id;
    EXPECT_EQ(east["points"][0]["x"], -179.99);
    EXPECT_EQ(served_->get("/v1/" + id + "?locations=10,-179.99").json()["results"][0]["state"],
              "surface");
    const json top = get(id + "/highest?bbox=179.98,9.96,-179.98,10").json();
    const json whole = get(id + "/highest?bbox=179.98,9.96,180.02,10").json();
    EXPECT_EQ(top, whole);
    EXPECT_FALSE(top["features"].empty()) << top;
  }
  const json beyond = get("degrees/position?f=json&coords=POINT(180.01%2010)").json();
  const json turned = get("degrees/position?f=json&coords=POINT(-179.99%2010)").json();
  EXPECT_EQ(beyond["points"][0]["height"], turned["points"][0]["height"]);
  // From east to west across it: the same line as the one that does not turn.
  const std::string line = "degrees/profile?f=csv&coords=";
  EXPECT_EQ(get(line + encoded("LINESTRING(179.98 10,-179.98 10)")).body,
            get(line + encoded("LINESTRING(179.98 10,180.02 10)")).body);
  // Positions come back from -180 to 180, and those of a line without a jump.
  for (const std::string id : {"degrees", "metres"}) {
    const json points =
        get(id + "/profile?coords=" + encoded("LINESTRING(-179.98 9.98,179.98 9.98)"))
            .json()["points"];
    EXPECT_NEAR(points.front()["x"].get<double>(), -179.98, 1e-9);
    EXPECT_NEAR(points.back()["x"].get<double>(), -180.02, 1e-9);
  }
  EXPECT_EQ(get("degrees/highest?bbox=20,9.96,10,10").json()["parameter"], "bbox");
  EXPECT_EQ(get("metres/mesh?crs=native&bbox=170000,0,10,10").json()["parameter"], "bbox");
}

TEST_F(ServeElsewhere, HoldsItsTerrainInItsExtent) {
  for (const serve::ServedFile& file : files_) {
    SCOPED_TRACE(file.id);
    const json collection = get(file.id).json();
    const json box = collection["extent"]["spatial"]["bbox"][0];
    const double west = box[0], south = box[1], north = box[3];
    const double east = box[2].get<double>() + (box[2] < box[0] ? 360 : 0);
    const Terrain terrain = Terrain::open(file.path);
    const Transformed to_globe(crs_facts(terrain.store()).wkt, "OGC:CRS84");
    const StoreFacts& facts = terrain.store().facts();
    double least = 90, most = -90;
    for (std::int32_t i = facts.bounds.min_x; i <= facts.bounds.max_x; ++i) {
      for (std::int32_t j = facts.bounds.min_y; j <= facts.bounds.max_y; ++j) {
        const MapPoint at = facts.map.to_map(i, j);
        Ecef p = to_globe({at.x, at.y, 0.0});
        if (p[0] < west - 1) p[0] += 360;
        EXPECT_TRUE(p[0] >= west && p[0] <= east && p[1] >= south && p[1] <= north)
            << p[0] << " " << p[1] << " " << box;
        least = std::min(least, p[1]);
        most = std::max(most, p[1]);
      }
    }
    EXPECT_LT(north - south, 1.1 * (most - least));
  }
  const json arctic = get("arctic").json()["extent"]["spatial"]["bbox"][0];
  EXPECT_EQ(arctic[3], 90.0);
  const json antarctic = get("antarctic").json()["extent"]["spatial"]["bbox"][0];
  EXPECT_EQ(antarctic[1], -90.0);
  for (const json& box : {arctic, antarctic}) {
    EXPECT_EQ(box[0], -180.0);
    EXPECT_EQ(box[2], 180.0);
  }
  EXPECT_EQ(get("antarctic/position?f=json&coords=POINT(77%20-90)").json()["points"][0]["state"],
            "surface");
  EXPECT_FALSE(get("antarctic/highest?bbox=-180,-90,180,-89.9").json()["features"].empty());
}

TEST_F(ServeElsewhere, HasTilesWhereNoPoleIs) {
  serve::ServeOptions options;
  options.http = unhurried_limits();
  // Finding out which tiles there are takes more than 4 MiB.
  options.files = files_;
  ServedTerrains served(options);
  const auto get = [&](const std::string& target) { return served.get("/collections/" + target); };
  for (const std::string id : {"arctic", "antarctic"}) {
    for (const std::string what : {"/tiles/layer.json", "/tileset.json"}) {
      const HttpAnswer answer = get(id + what);
      EXPECT_EQ(answer.status, 404);
      EXPECT_NE(answer.body.find("a pole lies within the terrain"), std::string::npos);
    }
  }
  const json layer = get("ross/tiles/layer.json").json();
  const json box = get("ross").json()["extent"]["spatial"]["bbox"][0];
  // Both halves are there: next to the last column, and from the first one on.
  const int z = layer["maxzoom"];
  std::set<bool> halves;
  for (const json& tiles : layer["available"][static_cast<std::size_t>(z)]) {
    halves.insert(tiles["startX"] < (1 << z));
    const std::string tile =
        std::to_string(z) + "/" + tiles["startX"].dump() + "/" + tiles["startY"].dump();
    EXPECT_EQ(get("ross/tiles/" + tile + ".terrain").status, 200) << tile;
  }
  EXPECT_EQ(halves.size(), 2U) << layer["available"];
  const json region = get("ross/tileset.json").json()["root"]["boundingVolume"]["region"];
  constexpr double kDegree = 180 / M_PI;
  EXPECT_GT(region[0].get<double>(), region[2].get<double>());  // Across the antimeridian.
  EXPECT_LE(region[0].get<double>() * kDegree, box[0].get<double>());
  EXPECT_GE(region[2].get<double>() * kDegree, box[2].get<double>());
  EXPECT_LT(region[1].get<double>(), region[3].get<double>());
}

TEST_F(Serve, DrawsThumbnailsOnce) {
  const std::string path = in("mountains", "thumbnail.png?width=64&height=40");
  const HttpAnswer drawn = get(path), kept = get(path);
  ASSERT_EQ(drawn.status, 200);
  EXPECT_EQ(drawn.header("content-type"), "image/png");
  const auto number = [&](std::size_t at) {
    return static_cast<unsigned char>(drawn.body.at(at)) * 256U +
           static_cast<unsigned char>(drawn.body.at(at + 1));
  };
  EXPECT_EQ(drawn.body.substr(1, 3), "PNG");
  EXPECT_EQ(number(18), 64U);  // Of the header: the width's lower half.
  EXPECT_EQ(number(22), 40U);
  EXPECT_EQ(kept.body, drawn.body);
  EXPECT_NE(kept.header("server-timing").find("cache"), std::string::npos);
  EXPECT_EQ(get(in("mountains", "thumbnail.png?width=8")).status, 400);
  EXPECT_EQ(get(in("mountains", "thumbnail.png?height=5000")).status, 400);
}

TEST_F(Serve, ListsItsTerrainsForPeopleWithoutScriptOrStyleOfThePage) {
  const std::string page = get("/", "Accept: text/html\r\n").body;
  for (const char* own : {"<script", "<style", "style=", "data:", "onclick"}) {
    EXPECT_EQ(page.find(own), std::string::npos) << own;
  }
  for (const char* told :
       {"collections/mountains/thumbnail.png", "viewer/index.html?collection=coast",
        "<svg class=\"map\"", "href=\"/style.css\"", "Heights above"}) {
    EXPECT_NE(page.find(told), std::string::npos) << told;
  }
  EXPECT_EQ(get("/style.css").header("content-type"), "text/css; charset=utf-8");
}

TEST_F(Serve, TellsTheLimitsOfAQuestion) {
  const json limits = get("/collections/mountains").json()["limits"];
  EXPECT_GT(limits["held_vertices"], 300000);  // As many as 64 MiB hold.
  EXPECT_LT(limits["held_vertices"], 500000);
  EXPECT_EQ(limits["question_memory"], std::uint64_t{64} << 20);
  EXPECT_TRUE(limits["computing"].is_number_unsigned());
}

TEST_F(Serve, GivesOutItsFilesByRanges) {
  const std::string file = read_file(files_[0].path);
  EXPECT_EQ(get(in("mountains", "file")).body, file);
  const HttpAnswer part = get(in("mountains", "file"), "Range: bytes=100-299\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, file.substr(100, 200));
  EXPECT_EQ(part.header("content-range"), "bytes 100-299/" + std::to_string(file.size()));
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=-50\r\n").body,
            file.substr(file.size() - 50));
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=0-9,20-29\r\n").status, 416);
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=999999999-\r\n").status, 416);
  EXPECT_EQ(get(in("mountains", "file"), "Range: lines=1-2\r\n").status, 200);
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=0-9\r\nIf-Range: \"old\"\r\n").status, 200);
  EXPECT_EQ(get(in("mountains", "file"), "If-None-Match: " + part.header("etag") + "\r\n").status,
            304);
}

}  // namespace
}  // namespace ptin::tools::testing
