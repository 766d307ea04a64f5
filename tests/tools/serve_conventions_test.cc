// SPDX-License-Identifier: GPL-3.0-or-later
//
// What HTTP promises of the service's answers: paths, tags, what caches may keep, tiles and the page.
#include <cstddef>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"
#include "tests/tools/tile_reader.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

class ServeConventions : public Serve {};

TEST_F(ServeConventions, KnowsNoCollectionWithoutAName) {
  for (const char* path : {"/collections/", "/collections//", "/collections//position",
                           "/collections//tiles/layer.json", "/collections//file"}) {
    EXPECT_EQ(get(path).status, 404) << path;
  }
  EXPECT_EQ(get("/collections").status, 200);
}

TEST_F(ServeConventions, RefusesBytesThatAreNoTextBehindATab) {
  EXPECT_EQ(get("/collections/m%09%ff").status, 400);
  EXPECT_EQ(get("/collections/m%09%00").status, 400);
  EXPECT_EQ(get("/collections/m%09").status, 404);
}

TEST_F(ServeConventions, RefusesLevelsBeyondCounting) {
  for (const char* asked : {"interval=1&base=1e17", "interval=1&base=1e300", "interval=1e-307",
                            "interval=1e-300&base=-1e30", "interval=1e-310"}) {
    const HttpAnswer answer = get("/collections/mountains/isolines?" + std::string(asked));
    EXPECT_TRUE(answer.status == 400 || answer.status == 413) << asked << answer.body;
  }
}

TEST_F(ServeConventions, TellsTheSameHeadersWhereNothingChanged) {
  for (const char* coding : {"", "Accept-Encoding: gzip\r\n"}) {
    const std::string target = "/collections/mountains/isolines?interval=200";
    const HttpAnswer whole = get(target, coding);
    ASSERT_EQ(whole.status, 200);
    for (const std::string& known : {whole.header("etag"), std::string("*")}) {
      const HttpAnswer same = get(target, coding + ("If-None-Match: " + known + "\r\n"));
      EXPECT_EQ(same.status, 304);
      EXPECT_EQ(same.header("cache-control"), whole.header("cache-control"));
      EXPECT_EQ(same.header("vary"), whole.header("vary"));
      EXPECT_EQ(same.header("etag"), known == "*" ? whole.header("etag") : known);
    }
  }
  for (const char* wrong :
       {"isolines?interval=-5", "position?coords=nonsense", "tiles/9/1/1.terrain", "subtrees/x"}) {
    const std::string target = "/collections/mountains/" + std::string(wrong);
    EXPECT_GE(get(target, "If-None-Match: *\r\n").status, 400) << wrong;
  }
}

TEST_F(ServeConventions, NamesTheMethodsThatAreAnswered) {
  const HttpAnswer mesh = served_->ask("POST", "/collections/mountains/mesh", "", "{}");
  EXPECT_EQ(mesh.status, 405);
  EXPECT_EQ(mesh.header("allow"), "GET, HEAD, OPTIONS");
  const HttpAnswer put = served_->ask("PUT", "/collections/mountains/position", "", "{}");
  EXPECT_EQ(put.status, 405);
  EXPECT_EQ(put.header("allow"), "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(served_->ask("OPTIONS", "/collections/mountains/mesh", "", "").header("allow"),
            "GET, HEAD, OPTIONS");
  EXPECT_FALSE(get("/healthz").header("date").empty());
  const std::string may_send =
      served_
          ->ask("OPTIONS", "/collections/mountains/file",
                "Origin: http://a\r\nAccess-Control-Request-Method: GET\r\n", "")
          .header("access-control-allow-headers");
  for (const char* header : {"If-Match", "If-Range", "If-Modified-Since", "If-Unmodified-Since"}) {
    EXPECT_NE(may_send.find(header), std::string::npos) << header;
  }
}

TEST_F(ServeConventions, GivesRangesOfFilesAsHttpHasThem) {
  const std::string file = "/collections/mountains/file";
  const HttpAnswer whole = served_->ask("HEAD", file, "Range: bytes=0-3\r\n", "");
  EXPECT_EQ(whole.status, 200);
  const std::string bytes = whole.header("content-length");
  const HttpAnswer beyond = get(file, "Range: bytes=" + bytes + "-\r\n");
  EXPECT_EQ(beyond.status, 416);
  EXPECT_EQ(beyond.header("content-range"), "bytes */" + bytes);
  EXPECT_EQ(get(file, "Range: bytes=99999999999999999999-\r\n").status, 416);
  EXPECT_EQ(get(file, "Range: bytes=0-99999999999999999999\r\n").header("content-length"), bytes);
  EXPECT_EQ(get(file, "Range: Bytes=0-3\r\n").body.size(), 4U);
  const std::string tag = whole.header("etag");
  EXPECT_EQ(get(file, "Range: bytes=0-3\r\nIf-Range: " + tag + "\r\n").status, 206);
  EXPECT_EQ(get(file, "Range: bytes=0-3\r\nIf-Range: W/" + tag + "\r\n").status, 200);
}

TEST_F(ServeConventions, GivesTilesThatMayBeKept) {
  const std::string root = "/collections/mountains/tiles/";
  const json layer = get(root + "layer.json").json();
  const int z = layer["maxzoom"];
  const json& some = layer["available"][static_cast<std::size_t>(z)][0];
  const std::string tile = root + std::to_string(z) + "/" + some["startX"].dump() + "/" +
                           some["startY"].dump() + ".terrain";
  const std::string version = layer["version"];
  const HttpAnswer now = get(tile + "?v=" + version, "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(now.status, 200);
  EXPECT_EQ(now.header("content-encoding"), "gzip");
  EXPECT_NE(now.header("cache-control").find("public"), std::string::npos);
  EXPECT_NE(now.header("cache-control").find("immutable"), std::string::npos);
  EXPECT_GT(std::stod(now.header("ptin-certified-error")), 0.0);
  EXPECT_EQ(get(tile + "?v=of_another_file").header("cache-control"), "no-cache");
  const HttpAnswer plain = get(tile);
  EXPECT_NE(plain.header("server-timing").find("query;dur="), std::string::npos);
  EXPECT_EQ(plain.header("server-timing").find("dur=0;"), std::string::npos);
  EXPECT_GT(read_terrain_tile(plain.body).triangles.size(), 10U);
  EXPECT_EQ(get(root + "9/1/1.terrain").status, 404);
}

TEST_F(ServeConventions, GivesATilesetWhoseTilesAreThere) {
  const std::string root = "/collections/mountains/";
  const json tileset = get(root + "tileset.json").json();
  EXPECT_EQ(tileset["asset"]["version"], "1.1");
  const HttpAnswer subtree = get(root + "subtrees/0/0/0.subtree");
  ASSERT_EQ(subtree.status, 200);
  EXPECT_EQ(subtree.body.substr(0, 4), "subt");
  const HttpAnswer content = get(root + "content/0/0/0.glb");
  ASSERT_EQ(content.status, 200);
  EXPECT_EQ(content.body.substr(0, 4), "glTF");
  EXPECT_EQ(get(root + "content/0/1/0.glb").status, 404);
}

TEST_F(ServeConventions, GivesThePageAsItIsPacked) {
  for (const ViewerFile& file : viewer_files()) {
    const std::string target = "/viewer/" + std::string(file.name);
    const HttpAnswer plain = get(target);
    EXPECT_EQ(plain.status, 200);
    EXPECT_EQ(plain.body, file.content);
    EXPECT_EQ(plain.header("content-type"), file.media_type);
    const HttpAnswer packed = get(target, "Accept-Encoding: gzip\r\n");
    EXPECT_EQ(packed.header("content-encoding"), "gzip");
    EXPECT_LT(packed.body.size(), file.content.size() * 2 / 3);
    const std::string known = "If-None-Match: " + packed.header("etag") + "\r\n";
    EXPECT_EQ(get(target, "Accept-Encoding: gzip\r\n" + known).status, 304);
    EXPECT_EQ(plain.header("content-security-policy"), viewer_policy(false));
  }
  const std::string policy = viewer_policy(false);
  EXPECT_NE(policy.find("script-src 'self' 'wasm-unsafe-eval'"), std::string::npos);
  EXPECT_NE(policy.find("style-src 'self'"), std::string::npos);
  EXPECT_EQ(policy.find("'unsafe-inline'"), std::string::npos);
  EXPECT_NE(policy.find("frame-ancestors 'self'"), std::string::npos);
  const HttpAnswer shown = get("/viewer/index.html?embed=1");
  EXPECT_NE(shown.header("content-security-policy").find("frame-ancestors *"), std::string::npos);
  EXPECT_EQ(get("/viewer/none.js").status, 404);
}

TEST_F(ServeConventions, PutsTheFirstPictureIntoThePage) {
  const HttpAnswer page = get("/viewer/index.html?collection=coast");
  EXPECT_EQ(page.status, 200);
  const std::size_t at = page.body.find(R"(id="first-mesh">)");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, page.body.find("</head>"));
  EXPECT_LT(page.body.size(), 60'000U);
  EXPECT_EQ(get("/viewer/index.html?collection=coast").header("etag"), page.header("etag"));
  const HttpAnswer packed = get("/viewer/index.html?collection=coast", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_EQ(get("/viewer/index.html").body.find("first-mesh"), std::string::npos);
  EXPECT_EQ(get("/viewer/index.html?collection=none").status, 200) << "the page tells it";
}

TEST_F(ServeConventions, AnswersTheLinksOfItsPage) {
  const std::string page = get("/", "Accept: text/html\r\n").body;
  constexpr std::string_view kLink = "<a href=\"";
  std::size_t links = 0;
  for (std::size_t at = 0; (at = page.find(kLink, at)) != std::string::npos; ++links) {
    at += kLink.size();
    const std::string target = page.substr(at, page.find('"', at) - at);
    EXPECT_EQ(get(target).status, 200) << target;
  }
  EXPECT_EQ(links, 6U);  // On the map and the facts of two terrains, /api and /collections.
  EXPECT_EQ(get("/viewer/?collection=coast&vertices=1000").status, 200);
}

TEST(ServeToken, KeepsTilesOutOfSharedCaches) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.token = "secret";
  ServedTerrains served(options);
  const std::string known = "Authorization: bearer secret\r\n";
  const std::string root = "/collections/mountains/tiles/";
  EXPECT_EQ(served.get(root + "layer.json").status, 401);
  const std::string version = served.get(root + "layer.json", known).json()["version"];
  const HttpAnswer tile = served.get(root + "0/0/0.terrain?v=" + version, known);
  EXPECT_EQ(tile.header("cache-control"), "private, max-age=31536000, immutable");
}

}  // namespace
}  // namespace ptin::tools::testing
