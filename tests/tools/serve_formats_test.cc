// SPDX-License-Identifier: GPL-3.0-or-later
//
// In which format an answer comes, and what a client may keep of it.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, ChoosesAFormatByWhatAcceptLikesBest) {
  const std::string position = in("mountains", "position?coords=POINT(-118.3%2034.34)");
  const struct {
    std::string target;
    const char* accept;
    const char* type;
  } all[] = {
      {position, "application/prs.coverage+json;q=0, application/geo+json", "application/geo+json"},
      {position, "text/csv;q=0.4, application/geo+json; q=0.9", "application/geo+json"},
      {position, "*/*", "application/prs.coverage+json"},
      {position, "Text/*", "text/csv; charset=utf-8"},
      {position, "application/geo+json, */*", "application/geo+json"},
      {position, "*/*;q=0.1, text/csv;q=0.2", "text/csv; charset=utf-8"},
      {position, "image/png", "application/prs.coverage+json"},
      {"/", "text/html, application/json;q=0.5", "text/html; charset=utf-8"},
      {"/", "", "application/json"},
  };
  for (const auto& one : all) {
    const HttpAnswer answer = get(one.target, "Accept: " + std::string(one.accept) + "\r\n");
    EXPECT_EQ(answer.header("content-type"), one.type) << one.target << " " << one.accept;
  }
  // Caches are told. (A picture is not packed, which would vary the answer too.)
  const std::string seen = in("mountains", "viewshed?radius=500&coords=POINT(-118.3%2034.34)");
  EXPECT_EQ(get(seen).header("vary"), "Accept");
  EXPECT_EQ(get(seen + "&f=png").header("vary"), "");
  for (const char* page : {"/", "/collections", "/collections/mountains", "/conformance", "/api"}) {
    EXPECT_EQ(get(std::string(page) + "?f=json").status, 200) << page;
    EXPECT_EQ(get(std::string(page) + "?f=xml").json()["parameter"], "f") << page;
  }
}

TEST_F(Serve, ValidatesWhatClientsKeep) {
  const std::string target = in("mountains", "isolines?interval=100&error=5");
  const HttpAnswer first = get(target);
  const std::string etag = first.header("etag");
  ASSERT_FALSE(etag.empty());
  const HttpAnswer again = get(target, "If-None-Match: " + etag + "\r\n");
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  // The same question written otherwise has the same tag, another one has another.
  EXPECT_EQ(get(in("mountains", "isolines?error=5&interval=100")).header("etag"), etag);
  EXPECT_NE(get(in("mountains", "isolines?error=5&interval=200")).header("etag"), etag);
  EXPECT_NE(get(in("coast", "isolines?error=5&interval=100")).header("etag"), etag);
  const HttpAnswer packed = get(target, "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_NE(packed.header("etag"), etag);
  EXPECT_LT(packed.body.size(), first.body.size() / 2);
  EXPECT_EQ(get(target, "If-None-Match: " + packed.header("etag") + "\r\n").status, 304);
  EXPECT_EQ(get(target, "Accept-Encoding: br, GZIP\r\n").body, packed.body);
  const HttpAnswer kept = get(target, "Accept-Encoding: gzip;q=0\r\n");
  EXPECT_EQ(kept.body, first.body);
  EXPECT_EQ(kept.header("server-timing"), "cache;desc=\"hit\"");
  EXPECT_NE(first.header("server-timing").find("pages="), std::string::npos);
  EXPECT_NE(first.header("server-timing").find(" samples="), std::string::npos);
  EXPECT_EQ(kept.header("ptin-certified-error"), "5");
}

}  // namespace
}  // namespace ptin::tools::testing
