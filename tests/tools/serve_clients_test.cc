// SPDX-License-Identifier: GPL-3.0-or-later
//
// Requests of others' clients, byte for byte where it matters: Google's and jQuery's, axios,
// GDAL's /vsicurl/, curl and wget.
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/ground.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

class ServeClients : public Serve {
 protected:
  static constexpr const char* kAt = "34.34,-118.3";
};

/// Positions as Google's client for Node writes 512 of them: `%2C` and `%7C` between the numbers.
std::string many_locations(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += (i > 0 ? "%7C" : "") + std::to_string(34.34 + i * 1e-5) + "%2C-118.30000000000001";
  }
  return text;
}

TEST_F(ServeClients, TakesAsManyLocationsAsGooglesClientSends) {
  const HttpAnswer answer = get("/v1/mountains?key=K&locations=" + many_locations(512));
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.json()["results"].size(), 512U);
}

TEST_F(ServeClients, IgnoresWhatTheirLibrariesAdd) {
  const std::string plain = std::string("/v1/mountains?locations=") + kAt;
  const json expected = get(plain).json();
  for (const char* extra :
       {"_=1732650000000", "key=K", "client=gme-x&signature=c2VjcmV0&channel=7", "sensor=true",
        "language=de&region=at", "solution_channel=GMP_guides", "units=metric"}) {
    const HttpAnswer answer = get(plain + "&" + extra);
    EXPECT_EQ(answer.status, 200) << extra;
    EXPECT_EQ(answer.json()["results"], expected["results"]) << extra;
  }
  EXPECT_EQ(get(plain + "&sample=3").json()["parameter"], "sample");
}

void expect_refusal(const HttpAnswer& answer, int status, const std::string& word) {
  EXPECT_EQ(answer.status, status) << answer.body;
  EXPECT_EQ(answer.header("content-type"), "application/json");
  const json body = answer.json();
  EXPECT_EQ(body["status"], word) << answer.body;
  EXPECT_FALSE(body["error_message"].get<std::string>().empty());
  EXPECT_EQ(body["results"], json::array());
}

TEST(ServeClientsRefused, HearsRefusalsInTheirOwnForm) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.http.body_bytes = 1024;
  options.question.points = 3;
  ServedTerrains served(options);
  const std::string path = "/v1/mountains?locations=";
  const auto get = [&](const std::string& target) {
    return HttpClient(served.address()).get(target);
  };
  for (const int count : {1500, 5000}) {  // Beyond the line alone, and beyond what is read of it.
    expect_refusal(get(path + many_locations(count)), 414, "INVALID_REQUEST");
  }
  expect_refusal(HttpClient(served.address()).ask("POST", path, "", std::string(2000, ' ')), 413,
                 "INVALID_REQUEST");
  expect_refusal(get(path + many_locations(4)), 413, "INVALID_REQUEST");
  expect_refusal(get("/v1/nobody?locations=1,2"), 404, "INVALID_REQUEST");
  const HttpAnswer method = HttpClient(served.address()).ask("PUT", path, "", "");
  expect_refusal(method, 405, "INVALID_REQUEST");
  EXPECT_EQ(method.header("allow"), "GET, HEAD, POST, OPTIONS");
  expect_refusal(
      HttpClient(served.address()).get(path + "1,2", "X: " + std::string(9000, 'x') + "\r\n"), 431,
      "INVALID_REQUEST");
  expect_refusal(get("/v1/mountains?locations=%zz"), 400, "INVALID_REQUEST");
  // Elsewhere they stay as they are.
  EXPECT_EQ(get("/collections/nobody").header("content-type"), "application/problem+json");
}

TEST(ServeClientsRefused, HearsOfTokensAndOfLoadInTheirOwnForm) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.token = "secret";
  options.question.question_memory = std::uint64_t{64} << 20;
  options.http.memory_bytes = std::uint64_t{8} << 20;  // The program refuses such options.
  ServedTerrains served(options);
  const HttpAnswer token = served.get("/v1/mountains?locations=1,2");
  expect_refusal(token, 401, "REQUEST_DENIED");
  EXPECT_EQ(token.header("www-authenticate"), "Bearer");
  const HttpAnswer load =
      served.get("/v1/mountains?locations=1,2", "Authorization: Bearer secret\r\n");
  expect_refusal(load, 503, "OVER_QUERY_LIMIT");
  EXPECT_EQ(load.header("retry-after"), "1");
  EXPECT_EQ(load.json()["limit"], "memory_bytes");
}

TEST_F(ServeClients, SamplesPathsAtEqualDistances) {
  // 60 degrees north, a quarter around: the geodesic bends to the north of 67.
  const json points =
      get("/v1/mountains?samples=7&path=" + encoded("60,0|60,90|60,91")).json()["results"];
  ASSERT_EQ(points.size(), 7U);
  EXPECT_NEAR(points[3]["location"]["lat"].get<double>(), 67.77, 0.05);
  EXPECT_EQ(points[0]["location"], json({{"lat", 60.0}, {"lng", 0.0}}));
  EXPECT_EQ(points[6]["location"], json({{"lat", 60.0}, {"lng", 91.0}}));
  const CrsFacts globe = crs_facts(
      R"(GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],)"
      R"(CS[ellipsoidal,2],AXIS["longitude",east],AXIS["latitude",north],ANGLEUNIT["degree",0.0174532925199433]])");
  const Ground ground = ground_of(globe);
  const auto place = [&](std::size_t i) {
    return MapPoint{points[i]["location"]["lng"], points[i]["location"]["lat"]};
  };
  const double step = ground.distance(place(0), place(1));
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_NEAR(ground.distance(place(i), place(i + 1)), step, 1e-4) << i;
  }
}

TEST_F(ServeClients, GivesLibrariesThatTakeJsonTheSameAsEveryoneElse) {
  const std::string position = in("mountains", "position?coords=POINT(-118.3%2034.34)");
  const std::string area = in("mountains", "area?resolution-x=2&coords=" +
                                               encoded("POLYGON((-118.31 34.34,-118.3 34.34,-118.3 "
                                                       "34.35,-118.31 34.34))"));
  const struct {
    std::string target;
    const char* accept;
    const char* type;
  } all[] = {
      {position, "application/json, text/plain, */*", "application/prs.coverage+json"},
      {position, "application/json, text/javascript, */*; q=0.01", "application/prs.coverage+json"},
      {position, "application/json", "application/json"},
      {position, "application/json;q=0.9, application/geo+json", "application/geo+json"},
      {position, "application/json, text/csv;q=0.5", "application/json"},
      {area, "application/json", "application/prs.coverage+json"},
      {area, "text/csv;q=0.5, application/json", "application/prs.coverage+json"},
      {area, "application/prs.coverage+json;q=0, application/json;q=0.3", "application/geo+json"},
      {position, "text/html, image/gif, image/jpeg, *; q=.2, */*; q=.2",
       "application/prs.coverage+json"},
      {"/", "application/json, text/plain, */*", "application/json"},
      {"/", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8",
       "text/html; charset=utf-8"},
  };
  for (const auto& one : all) {
    const HttpAnswer answer = get(one.target, "Accept: " + std::string(one.accept) + "\r\n");
    EXPECT_EQ(answer.header("content-type"), one.type) << one.target << " " << one.accept;
  }
  EXPECT_EQ(get(position, "Accept: application/json, text/plain, */*\r\n").body,
            get(position).body);
  // Several lines are one list.
  EXPECT_EQ(get(position, "Accept: image/png\r\nAccept: text/csv\r\n").header("content-type"),
            "text/csv; charset=utf-8");
}

TEST_F(ServeClients, GivesRangesOfComputedAnswers) {
  const std::string target = in("mountains", "isolines?interval=100");
  const HttpAnswer whole = get(target);
  EXPECT_EQ(whole.header("accept-ranges"), "bytes");
  const HttpAnswer head = served_->ask("HEAD", target, "", "");
  EXPECT_EQ(head.header("content-length"), std::to_string(whole.body.size()));
  for (const char* coding : {"", "Accept-Encoding: gzip\r\n"}) {
    const std::string bytes = get(target, coding).body;
    const HttpAnswer part = get(target, std::string(coding) + "Range: bytes=100-16383\r\n");
    EXPECT_EQ(part.status, 206);
    EXPECT_EQ(part.body, bytes.substr(100, 16284));
    EXPECT_EQ(part.header("content-range"), "bytes 100-" + std::to_string(99 + part.body.size()) +
                                                "/" + std::to_string(bytes.size()));
  }
  EXPECT_EQ(get(target, "Range: bytes=0-9\r\nIf-Range: " + whole.header("etag") + "\r\n").status,
            206);
  EXPECT_EQ(get(target, "Range: bytes=0-9\r\nIf-Range: \"other\"\r\n").body, whole.body);
  const HttpAnswer beyond = get(target, "Range: bytes=99999999-\r\n");
  EXPECT_EQ(beyond.status, 416);
  EXPECT_EQ(beyond.header("content-range"), "bytes */" + std::to_string(whole.body.size()));
}

TEST_F(ServeClients, KeepsThePreconditionsOfRequests) {
  for (const std::string& target :
       {in("mountains", "file"), in("mountains", "highest?crs=native")}) {
    SCOPED_TRACE(target);
    const HttpAnswer whole = get(target);
    const std::string etag = whole.header("etag");
    const struct {
      std::string headers;
      int status;
    } all[] = {
        {"If-None-Match: *", 304},
        {"If-None-Match: \"x\", " + etag, 304},
        {"If-None-Match: W/" + etag, 304},
        {"If-None-Match: \"x\"", 200},
        {"If-Match: \"x\"", 412},
        {"If-Match: *", 200},
        {"If-Match: \"x\", " + etag, 200},
        {"If-Match: W/" + etag, 412},
        {"If-Match: \"x\"\r\nIf-None-Match: " + etag, 412},
        {"If-Match: " + etag + "\r\nIf-None-Match: " + etag, 304},
        {"If-Match: \"x\"\r\nRange: bytes=0-3", 412},
        {"If-Match: " + etag + "\r\nRange: bytes=0-3", 206},
    };
    for (const auto& one : all) {
      EXPECT_EQ(get(target, one.headers + "\r\n").status, one.status) << one.headers;
      if (one.status == 206) continue;
      EXPECT_EQ(served_->ask("HEAD", target, one.headers + "\r\n", "").status, one.status)
          << one.headers;
    }
  }
}

TEST_F(ServeClients, KeepsTheDatesOfFiles) {
  const std::string target = in("mountains", "file");
  const std::string date = get(target).header("last-modified");
  ASSERT_EQ(date.size(), 29U) << date;
  const std::string old = "Sun, 06 Nov 1994 08:49:37 GMT";
  const struct {
    std::string headers;
    int status;
  } all[] = {
      {"If-Modified-Since: " + date, 304},
      {"If-Modified-Since: " + old, 200},
      {"If-Modified-Since: " + date + "\r\nIf-None-Match: \"x\"", 200},
      {"If-Modified-Since: yesterday", 200},
      {"If-Unmodified-Since: " + date, 200},
      {"If-Unmodified-Since: " + old, 412},
      {"If-Unmodified-Since: " + old + "\r\nIf-Match: *", 200},
      {"If-Unmodified-Since: yesterday", 200},
      {"Range: bytes=0-3\r\nIf-Range: " + date, 200},
      {"Range: bytes=-0", 416},
      {"Range: bytes=5-3", 200},
      {"Range: bytes=-99999999999", 206},
  };
  for (const auto& one : all) {
    EXPECT_EQ(get(target, one.headers + "\r\n").status, one.status) << one.headers;
  }
}

TEST_F(ServeClients, RefusesCrssWithoutPositions) {
  const std::string position = in("mountains", "position?coords=POINT(-118.3%2034.34)&crs=");
  for (const char* none : {"EPSG:5703", "EPSG:4978", "EPSG:5800", "EPSG:9999999",
                           "http://www.opengis.net/def/crs/EPSG/0/5773"}) {
    const HttpAnswer answer = get(position + none);
    EXPECT_EQ(answer.status, 400) << none;
    EXPECT_EQ(answer.json()["parameter"], "crs") << none;
  }
  EXPECT_NE(get(position + "EPSG:5703").body.find("has no positions in a plane"),
            std::string::npos);
  for (const char* known : {"EPSG:4979", "EPSG:5498", "urn:ogc:def:crs:EPSG::4326"}) {
    EXPECT_EQ(get(position + known).json()["ranges"]["height"],
              get(position).json()["ranges"]["height"])
        << known;
  }
}

}  // namespace
}  // namespace ptin::tools::testing
