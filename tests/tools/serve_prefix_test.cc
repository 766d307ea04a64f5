// SPDX-License-Identifier: GPL-3.0-or-later
//
// The service behind a proxy, at the root of a host and below a path: every address in its answers
// leads through the proxy to an answer.
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tests/tools/serve_fixture.h"
#include "tools/http/forwarded.h"
#include "tools/serve/config_file.h"
#include "tools/serve/public_address.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;
using serve::public_address_of;

serve::ServeOptions hills_options(const TestFolder& folder) {
  make_raster(folder.file("hills.tif"), {.value = hills});
  build_terrain(folder.file("hills.tif"), folder.file("hills.ptin"));
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.http.threads = 1;
  options.version = "test";
  options.files = {{"hills", folder.file("hills.ptin")}};
  return options;
}

/// A proxy that serves the service below an address, and a client that follows addresses.
struct Proxy {
  std::string root;       ///< What addresses begin with; a client resolves paths by its host.
  std::string prefix;     ///< The path in it.
  std::string headers;    ///< That the proxy adds.
  bool takes_off = true;  ///< The prefix from paths: proxy_pass with a slash behind the upstream.

  /// The answer to an address; none where it does not lead through this proxy.
  HttpAnswer follow(ServedTerrains& served, const std::string& address) const {
    std::string path = address;
    const std::size_t host_end = root.size() - prefix.size();
    if (path.starts_with("http")) {
      if (!path.starts_with(root)) return {};
      path = path.substr(host_end);
    }
    if (!path.starts_with(prefix + "/") && path != prefix) return {};
    if (takes_off) path = path.substr(prefix.size());
    return served.get(path.empty() ? "/" : path, headers);
  }
};

/// The address that a relative one means within a document.
std::string resolved(const std::string& document, const std::string& address) {
  if (address.starts_with("http") || address.starts_with("/")) return address;
  const std::string path = document.substr(0, document.find('?'));
  return path.substr(0, path.rfind('/') + 1) + address;
}

/// All texts under these names within a document.
void collect(const json& value, std::vector<std::string>& addresses) {
  for (const auto& [name, v] : value.items()) {
    const bool is_address = name == "href" || name == "url" || name == "uri";
    if (is_address && v.is_string()) addresses.push_back(v.get<std::string>());
    if (name == "tiles" && v.is_array()) addresses.push_back(v[0].get<std::string>());
    if (v.is_structured()) collect(v, addresses);
  }
}

/// The values of href and src, but for those that hold what they name.
std::vector<std::string> addresses_in_html(const std::string& page) {
  std::vector<std::string> addresses;
  for (const std::string_view name : {" href=\"", " src=\""}) {
    for (std::size_t at = page.find(name); at != std::string::npos; at = page.find(name, at + 1)) {
      const std::size_t begin = at + name.size();
      std::string address = page.substr(begin, page.find('"', begin) - begin);
      for (std::size_t amp; (amp = address.find("&amp;")) != std::string::npos;) {
        address.erase(amp + 1, 4);
      }
      if (!address.starts_with("data:") && !address.starts_with("#")) addresses.push_back(address);
    }
  }
  return addresses;
}

/// The first tile, and a question that wants parameters with them.
std::string asked_for(std::string address) {
  const auto put = [&](std::string_view mark, std::string_view value) {
    const std::size_t at = address.find(mark);
    if (at != std::string::npos) address.replace(at, mark.size(), value);
  };
  for (const std::string_view mark : {"{z}", "{x}", "{y}", "{level}", "{x}", "{y}"}) put(mark, "0");
  put("{version}", "1");
  const std::string place = "500500 3999500";
  const auto ask = [&](std::string_view end, const std::string& coords,
                       const std::string& more = {}) {
    if (address.ends_with(end)) address += "?crs=native&coords=" + encoded(coords) + more;
  };
  ask("/radius", "POINT(" + place + ")", "&within=100&within-units=m");
  ask("/corridor", "LINESTRING(" + place + ",500600 3999500)", "&corridor-width=100&width-units=m");
  if (address.ends_with("/cube")) address += "?crs=native&bbox=500500,3999500,500600,3999600";
  ask("/position", "POINT(" + place + ")");
  ask("/trajectory", "LINESTRING(" + place + ",500600 3999500)");
  ask("/area", "POLYGON((" + place + ",500600 3999500,500600 3999600," + place + "))");
  return address;
}

/// Follows every address from the landing page on. Returns how many there were, each counted once however it
/// is written.
std::size_t walk(ServedTerrains& served, const Proxy& proxy) {
  std::set<std::string> seen;
  const auto in_service = [&](const std::string& address) {
    const std::string& before = address.starts_with("http") ? proxy.root : proxy.prefix;
    const std::string path =
        address.substr(before.size(), address.find("&service=") - before.size());
    return path.empty() ? "/" : path;
  };
  std::vector<std::string> open = {proxy.prefix + "/", proxy.prefix + "/?f=html",
                                   proxy.prefix + "/collections/hills/tiles/layer.json",
                                   proxy.prefix + "/collections/hills/tileset.json"};
  while (!open.empty()) {
    const std::string address = asked_for(open.back());
    open.pop_back();
    if (!seen.insert(in_service(address)).second || seen.size() > 100) continue;
    const HttpAnswer answer = proxy.follow(served, address);
    EXPECT_EQ(answer.status, 200) << address << ": " << answer.body.substr(0, 300);
    const std::string type = answer.header("content-type");
    std::vector<std::string> found;
    if (type.find("json") != std::string::npos) collect(answer.json(), found);
    if (type.find("html") != std::string::npos) found = addresses_in_html(answer.body);
    for (std::string one : found) {
      // A TileJSON has whole addresses, by the header Host where no proxy tells of itself.
      const bool is_whole = address.ends_with("tilejson.json") && one.starts_with("http");
      if (is_whole && !proxy.root.starts_with("http")) one.erase(0, one.find('/', 8));
      if (one.starts_with("http://www.opengis.net") || one.starts_with("https://www.gnu.org")) {
        continue;
      }
      if (one.starts_with("/") || one.starts_with("http")) {
        EXPECT_TRUE(one.starts_with(proxy.root)) << address << " names " << one;
      }
      open.push_back(resolved(address, one));
    }
  }
  return seen.size();
}

TEST(ServePrefix, LeadsThroughTheProxyByEveryAddress) {
  TestFolder folder;
  serve::ServeOptions options = hills_options(folder);
  serve::add_trusted_proxies("127.0.0.1", options);
  ServedTerrains told(options);
  const std::string host =
      "X-Forwarded-Host: maps.example.org:8443\r\nX-Forwarded-Proto: https\r\n";
  const std::string full = "https://maps.example.org:8443";
  const std::size_t at_root = walk(told, {"", "", "", true});
  EXPECT_GE(at_root, 14U);
  EXPECT_EQ(walk(told, {full, "", host, true}), at_root);
  const std::string prefix = "X-Forwarded-Prefix: /terrain\r\n";
  EXPECT_EQ(walk(told, {full + "/terrain", "/terrain", host + prefix, true}), at_root);
  EXPECT_EQ(walk(told, {"/terrain", "/terrain", prefix, false}), at_root);
  EXPECT_EQ(walk(told, {"https://b.example/a/b", "/a/b",
                        "Forwarded: for=\"[2001:db8::1]\";proto=https;host=b.example\r\n"
                        "X-Forwarded-Prefix: /a/b/\r\n",
                        false}),
            at_root);
  options.http.trusted_proxies.clear();
  options.public_address = public_address_of("https://example.org/terrain/", "");
  ServedTerrains configured(options);
  EXPECT_EQ(walk(configured, {"https://example.org/terrain", "/terrain", host, true}), at_root);
  EXPECT_EQ(walk(configured, {"https://example.org/terrain", "/terrain", "", false}), at_root);
}

TEST(ServePrefix, CountsOnlyOfTrustedProxiesAndOnlyWhatAddressesHold) {
  TestFolder folder;
  serve::ServeOptions options = hills_options(folder);
  const std::string headers = "X-Forwarded-Host: evil.example\r\nX-Forwarded-Prefix: /evil\r\n";
  const auto self_of = [](ServedTerrains& served, const std::string& more) {
    return served.get("/collections", more).json().at("links")[0].at("href").get<std::string>();
  };
  {
    ServedTerrains untrusting(options);
    EXPECT_EQ(self_of(untrusting, headers), "/collections");
    EXPECT_EQ(untrusting.get("/evil/collections", headers).status, 404);
  }
  serve::add_trusted_proxies("127.0.0.1", options);
  ServedTerrains served(options);
  EXPECT_EQ(self_of(served, headers), "http://evil.example/evil/collections");
  // The proxy's own word is the last one.
  EXPECT_EQ(self_of(served, "X-Forwarded-Host: evil.example, good.example\r\n"),
            "http://good.example/collections");
  for (const char* host :
       {"a b", "a\"b", "a<b", "a/b", "user@a", "a:b", "a:", "[::1", "a:123456"}) {
    EXPECT_EQ(self_of(served, std::string("X-Forwarded-Host: ") + host + "\r\n"), "/collections")
        << host;
  }
  for (const char* prefix : {"terrain", "//evil.example", "/a b", "/a\"b", "/..", "/a/../b",
                             "/a//b", "/collections", "/healthz/a", "/%2e", "/a?b"}) {
    EXPECT_EQ(self_of(served, std::string("X-Forwarded-Prefix: ") + prefix + "\r\n"),
              "/collections")
        << prefix;
  }
  EXPECT_EQ(self_of(served, "X-Forwarded-Host: a\r\nX-Forwarded-Proto: javascript\r\n"),
            "http://a/collections");
  // One answer is not kept for another address.
  const std::string plain = served.get("/collections/hills").header("etag");
  const HttpAnswer other = served.get("/collections/hills", headers);
  EXPECT_NE(other.header("etag"), plain);
  EXPECT_EQ(served.get("/collections/hills").json().at("links")[0].at("href"),
            "/collections/hills");
}

TEST(ServePrefix, HoldsCookiesAndRedirectsBelowIt) {
  TestFolder folder;
  serve::ServeOptions options = hills_options(folder);
  options.token = "secret";
  options.public_address = public_address_of("https://example.org/terrain/", "");
  ServedTerrains served(options);
  for (const char* target : {"/terrain/collections?token=secret", "/collections?token=secret"}) {
    const HttpAnswer login = served.get(target);
    EXPECT_EQ(login.status, 303);
    EXPECT_EQ(login.header("location"), "/terrain/collections");
    EXPECT_NE(login.header("set-cookie").find("; Path=/terrain;"), std::string::npos);
  }
  EXPECT_EQ(served.get("/terrain?token=secret").header("location"), "/terrain/");
  EXPECT_EQ(served.get("/terrain/healthz").body, "alive\n");
}

TEST(PublicAddress, IsAUrlOfHttp) {
  const auto base = [](const std::string& url) {
    const serve::PublicAddress address = public_address_of(url, "--public-url");
    return address.origin + "|" + address.prefix;
  };
  EXPECT_EQ(base("https://example.org"), "https://example.org|");
  EXPECT_EQ(base("http://[::1]:8080/a/b//"), "http://[::1]:8080|/a/b");
  for (const char* bad : {"example.org", "ftp://a/", "https://", "https:///a", "https://a b/",
                          "https://a/?q", "https://a/#f", "https://me@a/", "https://a/b\r\nc",
                          "https://a/collections", "https://a/metrics/b", "https://a/api"}) {
    try {
      static_cast<void>(base(bad));
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << bad;
    }
  }
}

TEST(Forwarded, IsWhatTheLastProxySays) {
  const http::Forwarded told = http::forwarded_of(
      {{"forwarded", "for=192.0.2.1;host=\"evil,example\""},
       {"forwarded", "For=\"[2001:db8::1]:80\" ; Proto=HTTPS;host=\"a.example:81\""},
       {"x-forwarded-proto", "http, https"}});
  EXPECT_EQ(told.proto, "https");
  EXPECT_EQ(told.host, "a.example:81");
  EXPECT_EQ(told.client, "192.0.2.1,[2001:db8::1]:80");
  EXPECT_EQ(told.prefix, "");
  EXPECT_EQ(http::forwarded_of({{"x-forwarded-for", "a"}, {"forwarded", "for=b"}}).client, "a");
}

}  // namespace
}  // namespace ptin::tools::testing
