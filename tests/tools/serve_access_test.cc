// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who may ask, from where, and what the service tells of itself.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/serve_fixture.h"
#include "tools/http/client_address.h"
#include "tools/http/descriptors.h"
#include "tools/serve/config_file.h"

namespace ptin::tools::testing {
namespace {

namespace fs = std::filesystem;
namespace ip = boost::asio::ip;

serve::ServeOptions with_token(const TestFolder& folder) {
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"dem", built(folder, "mountains_257.tif")}};
  options.http.threads = 2;
  options.version = "test";
  options.token = "a secret";
  return options;
}

TEST(ServeAccess, TurnsATokenInTheAddressIntoACookie) {
  TestFolder folder;
  ServedTerrains served(with_token(folder));
  EXPECT_EQ(served.get("/").status, 401);
  EXPECT_EQ(served.get("/?token=another").status, 401);
  const HttpAnswer login = served.get("/viewer/index.html?collection=dem&token=a%20secret");
  EXPECT_EQ(login.status, 303);
  EXPECT_EQ(login.header("location"), "/viewer/index.html?collection=dem");
  const std::string cookie = login.header("set-cookie");
  EXPECT_NE(cookie.find("HttpOnly"), std::string::npos);
  EXPECT_NE(cookie.find("SameSite=Strict"), std::string::npos);
  EXPECT_EQ(cookie.find("Secure"), std::string::npos);
  const std::string sent = "Cookie: other=1; " + cookie.substr(0, cookie.find(';')) + "\r\n";
  for (const char* target : {"/", "/viewer/index.html?collection=dem", "/collections/dem",
                             "/collections/dem/tiles/layer.json", "/metrics"}) {
    EXPECT_EQ(served.get(target, sent).status, 200) << target;
    EXPECT_EQ(served.get(target).status, 401) << target;
  }
  EXPECT_EQ(served.log().find("secret"), std::string::npos) << served.log();
}

TEST(ServeAccess, LeadsNowhereElse) {
  TestFolder folder;
  ServedTerrains served(with_token(folder));
  for (const char* target : {"//example.org/?token=a%20secret", "/%5cexample.org?token=a%20secret",
                             "http://example.org/?token=a%20secret"}) {
    const std::string to = served.get(target).header("location");
    EXPECT_EQ(to.front(), '/') << to;
    EXPECT_NE(to.substr(0, 2), "//");
    EXPECT_NE(to.substr(0, 2), "/\\");
  }
}

TEST(ServeAccess, ClosesItsMetrics) {
  TestFolder folder;
  serve::ServeOptions options = with_token(folder);
  options.metrics = serve::metrics_for("open", "");
  EXPECT_EQ(ServedTerrains(options).get("/metrics").status, 200);
  options.metrics = serve::metrics_for("closed", "");
  options.token.clear();
  EXPECT_EQ(ServedTerrains(options).get("/metrics").status, 403);
  EXPECT_THROW(static_cast<void>(serve::metrics_for("perhaps", "")), Error);
}

TEST(ServeAccess, TakesTheClientFromATrustedProxy) {
  TestFolder folder;
  serve::ServeOptions options = with_token(folder);
  serve::add_trusted_proxies("10.0.0.0/8, 127.0.0.1", options);
  ServedTerrains served(options);
  const HttpAnswer login = served.get("/?token=a%20secret",
                                      "X-Forwarded-For: 192.0.2.7\r\nX-Forwarded-Proto: https\r\n");
  EXPECT_NE(login.header("set-cookie").find("; Secure"), std::string::npos);
  EXPECT_TRUE(comes_true([&] {  // The line is written after the answer.
    return served.log().find("\"remote\":\"192.0.2.7\"") != std::string::npos;
  }));
}

TEST(ServeAccess, SaysWhichFileIsDamaged) {
  TestFolder folder;
  serve::ServeOptions options = with_token(folder);
  options.token.clear();
  options.offers_files = true;
  const std::string dem = folder.file("served.ptin");
  fs::copy_file(options.files[0].path, dem);
  options.files[0].path = dem;
  ServedTerrains served(options);
  EXPECT_EQ(served.get("/readyz").body, "ready\n");
  fs::resize_file(dem, fs::file_size(dem) / 2);
  EXPECT_EQ(served.get("/collections/dem/file").status, 500);
  EXPECT_EQ(served.get("/readyz").status, 503);
  EXPECT_EQ(served.get("/readyz").body, "damaged: dem\n");
  EXPECT_NE(served.get("/metrics").body.find("ptin_store_failures_total{collection=\"dem\"} 1"),
            std::string::npos);
  fs::copy_file(built(folder, "mountains_257.tif", "again.ptin"), dem,
                fs::copy_options::overwrite_existing);
  EXPECT_EQ(served.get("/collections/dem").status, 200);
  EXPECT_EQ(served.get("/readyz").status, 200);
}

TEST(ClientAddress, IsTheLastOneThatIsNoProxy) {
  const std::vector<http::Network> trusted = {http::parse_network("10.0.0.0/8"),
                                              http::parse_network("fd00::/8")};
  const auto client = [&](const char* connected, const char* said) {
    return http::client_of(ip::make_address(connected), said, trusted).to_string();
  };
  EXPECT_EQ(client("192.0.2.1", "198.51.100.1"), "192.0.2.1");
  EXPECT_EQ(client("10.0.0.1", ""), "10.0.0.1");
  EXPECT_EQ(client("10.0.0.1", "198.51.100.1"), "198.51.100.1");
  EXPECT_EQ(client("10.0.0.1", "203.0.113.9, 198.51.100.1:4711,10.2.3.4"), "198.51.100.1");
  EXPECT_EQ(client("::ffff:10.0.0.1", "[2001:db8::1]:80"), "2001:db8::1");
  EXPECT_EQ(client("10.0.0.1", "198.51.100.1, unknown"), "10.0.0.1");
  EXPECT_EQ(client("fd00::1", "2001:db8::1"), "2001:db8::1");
  for (const char* text : {"", "host", "10.0.0.0/33", "10.0.0.0/", "fd00::/129", "10.0.0.0/8x"}) {
    EXPECT_THROW(static_cast<void>(http::parse_network(text)), Error) << text;
  }
  EXPECT_EQ(http::share_of(ip::make_address("2001:db8:1:2:3::4")), "2001:db8:1:2::/64");
  EXPECT_EQ(http::share_of(ip::make_address("::ffff:192.0.2.1")), "192.0.2.1");
}

TEST(Descriptors, LeaveRoomBesideConnections) {
  EXPECT_EQ(http::connections_for(1024, 36, 1), 924U);
  EXPECT_EQ(http::connections_for(1024, 36, 2), 462U);
  EXPECT_EQ(http::connections_for(64, 36, 1), 1U);
  EXPECT_GT(http::open_descriptors(), 2U);
}

}  // namespace
}  // namespace ptin::tools::testing
