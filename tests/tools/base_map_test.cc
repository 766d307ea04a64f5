// SPDX-License-Identifier: GPL-3.0-or-later
//
// A base map: what files and services say of it, what the service's page may ask, and which templates are none.
#include "engine/crs/base_map.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/test_folder.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"
#include "tools/serve/config_file.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::tools::testing {

namespace {

constexpr const char* kTiles = "https://tiles.example.org:8443/a/{z}/{x}/{y}.png?key=1";

std::string words_of(const BaseMap& map) {
  const char* const fault = fault_of(map);
  return fault == nullptr ? "" : fault;
}

TEST(BaseMap, IsAnAddressWithThreePlaces) {
  EXPECT_EQ(words_of({kTiles, "\u00a9 Someone"}), "");
  EXPECT_EQ(BaseMap({kTiles, ""}).origin(), "https://tiles.example.org:8443");
  EXPECT_EQ(words_of({"http://h/wmts?SERVICE=WMTS&TILEMATRIX=EPSG:3857:{TileMatrix}"
                      "&TILEROW={TileRow}&TILECOL={TileCol}",
                      ""}),
            "");
  EXPECT_EQ(words_of({}), "");
  EXPECT_EQ(BaseMap().origin(), "");
  for (const char* tiles :
       {"https://h/{z}/{x}.png", "https://h/{z}/{x}/{TileRow}.png", "https://{s}.h/{z}/{x}/{y}.png",
        "https://h/{z}/{x}/{-y}.png", "https://h/{z}/{x}/{y}{r}.png", "//h/{z}/{x}/{y}.png",
        "ftp://h/{z}/{x}/{y}.png", "https://a@h/{z}/{x}/{y}.png", "https://h/{z}/{x}/{y}.png#a",
        "https://h;script-src *//{z}/{x}/{y}", "https://h/{z}/{x}/{y} .png"}) {
    EXPECT_NE(words_of({tiles, ""}).find("a base map is an address of tiles"), std::string::npos)
        << tiles;
  }
  EXPECT_NE(words_of({"", "Someone"}).find("--base-map"), std::string::npos);
  EXPECT_NE(words_of({kTiles, "a\nb"}).find("1,000 bytes"), std::string::npos);
}

TEST(BaseMap, IsReadFromConfigurationAndCommandLine) {
  TestFolder folder;
  write_file(folder.file("serve.toml"),
             std::string("base_map = \"") + kTiles + "\"\nbase_map_attribution = \"Someone\"\n");
  serve::ServeOptions options;
  serve::read_config(folder.file("serve.toml"), options);
  EXPECT_EQ(options.base_map.value().tiles, kTiles);
  EXPECT_EQ(options.base_map.value().attribution, "Someone");
  const Outcome outcome = run_ptin({"serve", "none.ptin", "--base-map", "https://h/{z}"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("{TileMatrix}"), std::string::npos) << outcome.err;
}

TEST(BaseMap, IsToldByCollectionsAndAllowedToTheirPage) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  std::string etag;
  {
    ServedTerrains without(options);
    const HttpAnswer told = without.get("/collections/coast");
    EXPECT_FALSE(told.json().contains("base_map"));
    etag = told.header("etag");
    const std::string policy =
        without.get("/viewer/index.html?collection=coast").header("content-security-policy");
    EXPECT_EQ(policy, viewer_policy(false, ""));
    EXPECT_EQ(policy.find("http"), std::string::npos) << "a page of the service asks nobody else";
  }
  options.base_map = BaseMap{kTiles, "Someone"};
  ServedTerrains with(options);
  const HttpAnswer told = with.get("/collections/coast", "If-None-Match: " + etag + "\r\n");
  ASSERT_EQ(told.status, 200) << "it is another answer";
  EXPECT_EQ(told.json()["base_map"],
            (nlohmann::json{{"tiles", kTiles}, {"attribution", "Someone"}}));
  const std::string policy =
      with.get("/viewer/index.html?collection=coast").header("content-security-policy");
  EXPECT_NE(policy.find("connect-src 'self' blob: https://tiles.example.org:8443;"),
            std::string::npos)
      << policy;
  EXPECT_EQ(policy.find("https: http:"), std::string::npos);
}

TEST(BaseMap, IsTheFilesWhereTheServiceNamesNone) {
  TestFolder folder;
  make_raster(folder.file("hills.tif"), {.value = hills});
  const std::string store = folder.file("hills.ptin");
  const std::vector<std::string> build = {"build", folder.file("hills.tif"), "-q", "-o", store};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), build.begin(), build.end());
    return more;
  };
  const Outcome refused = run_ptin(with({"--base-map", "https://h/{z}/{x}"}));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("{TileMatrix}"), std::string::npos) << refused.err;
  EXPECT_EQ(run_ptin(with({"--base-map-attribution", "Someone"})).status, 2);
  expect_done(with({"--base-map", kTiles, "--base-map-attribution", "Someone"}));
  const nlohmann::json map = {{"tiles", kTiles}, {"attribution", "Someone"}};
  EXPECT_EQ(answer_of({"info", store, "--json"}).at("base_map"), map);
  const std::string told = run_ptin({"info", store}).out;
  EXPECT_NE(told.find(std::string("base map   ") + kTiles + " (Someone)\n"), std::string::npos)
      << told;
  expect_done({"stream", store, "-o", folder.file("hills.pts"), "--splits", "0"});
  EXPECT_NE(read_file(folder.file("hills.pts")).find("\"base_map\":" + map.dump()),
            std::string::npos);

  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"hills", store}};
  const auto served = [&] {
    ServedTerrains terrains(options);
    const nlohmann::json collection = terrains.get("/collections/hills").json();
    return std::pair(
        collection.value("base_map", nlohmann::json()),
        terrains.get("/viewer/index.html?collection=hills").header("content-security-policy"));
  };
  EXPECT_EQ(served(), std::pair(map, viewer_policy(false, "https://tiles.example.org:8443")));
  serve::set_base_map_tiles("http://other/{z}/{x}/{y}", options);
  EXPECT_EQ(served().first,
            (nlohmann::json{{"tiles", "http://other/{z}/{x}/{y}"}, {"attribution", ""}}));
  serve::set_base_map_tiles("none", options);
  EXPECT_EQ(served(), std::pair(nlohmann::json(), viewer_policy(false, "")));
}

TEST(BaseMap, OfAFileThatNoBuildWritesIsNone) {
  const auto map_of = [](nlohmann::json options) {
    return base_map_of(nlohmann::json{{"options", std::move(options)}}).tiles;
  };
  EXPECT_EQ(map_of({{"base_map", kTiles}}), kTiles);
  EXPECT_EQ(map_of({{"base_map", "https://h;script-src *//{z}/{x}/{y}"}}), "");
  EXPECT_EQ(map_of({{"base_map", kTiles}, {"base_map_attribution", "a\nb"}}), "");
  EXPECT_EQ(map_of({{"base_map", 7}}), "");
}

}  // namespace

}  // namespace ptin::tools::testing
