// SPDX-License-Identifier: GPL-3.0-or-later
//
// A base map: what a service says of it, what its page may ask, and which templates are none.
#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/support/test_folder.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"
#include "tools/serve/base_map.h"
#include "tools/serve/config_file.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::tools::testing {

namespace {

constexpr const char* kTiles = "https://tiles.example.org:8443/a/{z}/{x}/{y}.png?key=1";

std::string fault_of(const serve::BaseMap& map) {
  try {
    serve::check_base_map(map);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(BaseMap, IsAnAddressWithThreePlaces) {
  EXPECT_EQ(fault_of({kTiles, "\u00a9 Someone"}), "");
  EXPECT_EQ(serve::BaseMap({kTiles, ""}).origin(), "https://tiles.example.org:8443");
  EXPECT_EQ(fault_of({"http://h/wmts?SERVICE=WMTS&TILEMATRIX=EPSG:3857:{TileMatrix}"
                      "&TILEROW={TileRow}&TILECOL={TileCol}",
                      ""}),
            "");
  EXPECT_EQ(fault_of({}), "");
  EXPECT_EQ(serve::BaseMap().origin(), "");
  for (const char* tiles :
       {"https://h/{z}/{x}.png", "https://h/{z}/{x}/{TileRow}.png", "https://{s}.h/{z}/{x}/{y}.png",
        "https://h/{z}/{x}/{-y}.png", "https://h/{z}/{x}/{y}{r}.png", "//h/{z}/{x}/{y}.png",
        "ftp://h/{z}/{x}/{y}.png", "https://a@h/{z}/{x}/{y}.png", "https://h/{z}/{x}/{y}.png#a",
        "https://h;script-src *//{z}/{x}/{y}", "https://h/{z}/{x}/{y} .png"}) {
    EXPECT_NE(fault_of({tiles, ""}).find("is no address of tiles"), std::string::npos) << tiles;
  }
  EXPECT_NE(fault_of({"", "Someone"}).find("--base-map"), std::string::npos);
  EXPECT_NE(fault_of({kTiles, "a\nb"}).find("1,000 bytes"), std::string::npos);
}

TEST(BaseMap, IsReadFromConfigurationAndCommandLine) {
  TestFolder folder;
  write_file(folder.file("serve.toml"),
             std::string("base_map = \"") + kTiles + "\"\nbase_map_attribution = \"Someone\"\n");
  serve::ServeOptions options;
  serve::read_config(folder.file("serve.toml"), options);
  EXPECT_EQ(options.base_map.tiles, kTiles);
  EXPECT_EQ(options.base_map.attribution, "Someone");
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
  options.base_map = {kTiles, "Someone"};
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

}  // namespace

}  // namespace ptin::tools::testing
