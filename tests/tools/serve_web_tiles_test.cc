// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles of web maps over HTTP: their TileJSON, which tiles there are, what is refused.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

class ServeWebTiles : public Serve {
 protected:
  /// The path of an address that a TileJSON tells, with a tile's numbers.
  static std::string tile_of(const json& tilejson, int z, int x, int y) {
    std::string address = tilejson["tiles"][0];
    const auto put = [&](const std::string& name, int number) {
      address.replace(address.find(name), name.size(), std::to_string(number));
    };
    put("{z}", z);
    put("{x}", x);
    put("{y}", y);
    return address.substr(address.find("/collections"));
  }
};

TEST_F(ServeWebTiles, TellOfThemselvesAsTileJson) {
  for (const std::string what : {"dem", "contours"}) {
    const HttpAnswer answer = get(in("mountains", what + "/tilejson.json"), "X: y\r\n");
    ASSERT_EQ(answer.status, 200) << answer.body;
    const json told = answer.json();
    EXPECT_EQ(told["tilejson"], what == "dem" ? "2.2.0" : "3.0.0");
    EXPECT_EQ(told["minzoom"], 0);
    const char* const of_zooms = what == "dem" ? "ptin:errors" : "ptin:intervals";
    EXPECT_EQ(told[of_zooms].size(), told["maxzoom"].get<std::size_t>() + 1);
    EXPECT_EQ(told["tiles"][0].get<std::string>().rfind("http://", 0), 0U);
    EXPECT_EQ(told["bounds"].size(), 4U);
    const HttpAnswer tile = get(tile_of(told, 0, 0, 0));
    EXPECT_EQ(tile.status, 200);
    // Lines are rounded to steps of their tile: nothing is certified of them.
    EXPECT_EQ(tile.header("ptin-certified-error").empty(), what == "contours");
    EXPECT_EQ(told.contains("ptin:errors"), what == "dem");
    EXPECT_NE(tile.header("cache-control").find("immutable"), std::string::npos);
    EXPECT_EQ(get(tile_of(told, 0, 0, 0), "If-None-Match: " + tile.header("etag") + "\r\n").status,
              304);
  }
  const json told =
      get(in("mountains", "dem/tilejson.json?encoding=terrarium&size=512&format=webp")).json();
  EXPECT_EQ(told["encoding"], "terrarium");
  EXPECT_EQ(told["tile_size"], 512);
  EXPECT_EQ(get(tile_of(told, 0, 0, 0)).header("content-type"), "image/webp");
}

TEST_F(ServeWebTiles, AreThereWhereTheTerrainIs) {
  for (const std::string ending :
       {"dem/0/0/0.png", "dem/0/0/0.webp", "contours/0/0/0.mvt", "contours/0/0/0.pbf"}) {
    EXPECT_EQ(get(in("coast", ending)).status, 200) << ending;
  }
  for (const std::string ending :
       {"dem/1/5/0.png", "dem/29/0/0.png", "dem/3/0/0.png", "dem/-1/0/0.png", "dem/0/0/0.tif",
        "dem/0/0.png", "dem/", "contours/3/0/0.mvt", "contours/99/0/0.mvt", "contours/0/0/0.png"}) {
    EXPECT_EQ(get(in("coast", ending)).status, 404) << ending;
  }
}

TEST_F(ServeWebTiles, RefuseWhatMeansNothing) {
  for (const std::string query :
       {"dem/0/0/0.png?encoding=grey", "dem/0/0/0.png?size=128", "dem/0/0/0.png?voids=maybe",
        "contours/0/0/0.mvt?interval=0", "contours/0/0/0.mvt?interval=0.0001",
        "contours/tilejson.json?interval=0.0001"}) {
    const HttpAnswer answer = get(in("mountains", query));
    EXPECT_EQ(answer.status, 400) << query;
    EXPECT_TRUE(answer.json().contains("parameter")) << answer.body;
  }
}

TEST_F(ServeWebTiles, AreToldByTheHostThatWasAsked) {
  const std::string target = in("mountains", "dem/tilejson.json");
  const json here = get(target).json();
  EXPECT_EQ(here["tiles"], get(target).json()["tiles"]);
  EXPECT_NE(here["tiles"][0].get<std::string>().find("/collections/mountains/dem/"),
            std::string::npos);
}

}  // namespace
}  // namespace ptin::tools::testing
