// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin serve` on a socket of the file system, and SIGHUP.
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "engine/error.h"
#include "tests/tools/http_client.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(static_cast<char*>(address.sun_path), sizeof address.sun_path - 1);
  return address;
}

/// What a socket answers to a GET; empty: nobody listens.
std::string asked_at(const std::string& path, const std::string& target,
                     const std::string& headers = {}) {
  const sockaddr_un address = address_of(path);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  std::string answer;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    const std::string request =
        "GET " + target + " HTTP/1.1\r\nHost: a\r\nConnection: close\r\n" + headers + "\r\n";
    EXPECT_EQ(::write(socket, request.data(), request.size()),
              static_cast<ssize_t>(request.size()));
    char part[4096];
    for (ssize_t got = 0; (got = ::read(socket, part, sizeof part)) > 0;) {
      answer.append(part, static_cast<std::size_t>(got));
    }
  }
  ::close(socket);
  return answer;
}

/// A socket that nobody listens on any more.
void leave_socket(const std::string& path) {
  const sockaddr_un address = address_of(path);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(socket);
}

unsigned mode_of(const std::string& path) {
  struct stat facts {};
  EXPECT_EQ(::lstat(path.c_str(), &facts), 0) << path;
  return facts.st_mode & 0777U;
}

/// Hills under a name.
serve::ServedFile hills_file(const TestFolder& folder, const std::string& name) {
  make_raster(folder.file("hills.tif"), {.value = hills});
  build_terrain(folder.file("hills.tif"), folder.file(name + ".ptin"));
  return {name, folder.file(name + ".ptin")};
}

TEST(UnixSocket, AnswersThoseWhomItsModeLetsAndIsGoneAtTheEnd) {
  const TestFolder folder;
  const std::string path = folder.file("s");
  leave_socket(path);
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {hills_file(folder, "hills")};
  std::string log;
  serve::TerrainService service(options, [&](const std::string& line) { log += line; });
  {
    http::Server server("unix:" + path + ",mode=620", options.http, service);
    EXPECT_EQ(server.address(), "unix:" + path);
    EXPECT_EQ(mode_of(path), 0620U);
    std::thread runs([&] { server.run(); });
    EXPECT_NE(asked_at(path, "/healthz").find("alive"), std::string::npos);
    // Who may open it is trusted as a proxy is.
    const std::string told = asked_at(
        path, "/collections", "X-Forwarded-Host: a.example\r\nX-Forwarded-For: 192.0.2.7\r\n");
    EXPECT_NE(told.find("\"http://a.example/collections\""), std::string::npos) << told;
    EXPECT_THROW(http::Server("unix:" + path, options.http, service), Error);  // in use
    EXPECT_NE(asked_at(path, "/healthz").find("alive"), std::string::npos);
    server.drain();
    runs.join();
    EXPECT_FALSE(fs::exists(path));
  }
  EXPECT_NE(log.find("\"remote\":\"192.0.2.7\""), std::string::npos) << log;
  EXPECT_NE(log.find("\"remote\":\"unix\""), std::string::npos) << log;
  {
    http::Server server("unix:" + path, options.http, service);
    EXPECT_EQ(mode_of(path), 0600U);
    fs::remove(path);
    leave_socket(path);  // of somebody else
  }
  EXPECT_TRUE(fs::exists(path));
}

TEST(UnixSocket, RefusesWhatIsNone) {
  const TestFolder folder;
  write_file(folder.file("text"), "a");
  const serve::ServedFile file = hills_file(folder, "hills");
  const struct {
    std::string listen;
    int status;
    const char* says;
  } all[] = {{"unix:s", 2, "from the root"},
             {"unix:" + folder.file("s") + ",mode=9", 2, "octal"},
             {"unix:" + folder.file("s") + ",mode=1777", 2, "octal"},
             {"unix:/" + std::string(200, 'a'), 2, "107 bytes"},
             {"unix:" + folder.file("text"), 2, "something else than a socket"},
             {"unix:" + folder.file("none") + "/s", 3, "cannot listen"}};
  for (const auto& one : all) {
    const Outcome outcome = run_ptin({"serve", file.path, "--listen", one.listen});
    EXPECT_EQ(outcome.status, one.status) << one.listen << outcome.err;
    EXPECT_NE(outcome.err.find(one.says), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(read_file(folder.file("text")), "a");
}

TEST(ServeReload, TakesTheCollectionsOfTheMoment) {
  const TestFolder folder;
  const serve::ServedFile a = hills_file(folder, "a"), b = hills_file(folder, "b");
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.http.threads = 1;
  options.files = {a};
  ServedTerrains served(options);
  const std::string etag = served.get("/collections/a").header("etag");
  served.service().reload([&] { return serve::Reread{{a, b}, {}}; });
  EXPECT_EQ(served.get("/collections/b").status, 200);
  EXPECT_EQ(served.get("/collections/a").header("etag"), etag);
  EXPECT_NE(served.log().find(R"("event":"reload","collections":["a","b"])"), std::string::npos);
  // What is broken leaves all as it was.
  served.service().reload([]() -> serve::Reread { refuse("no TOML", "a.toml"); });
  served.service().reload([&] { return serve::Reread{{{"c", folder.file("c")}}, {}}; });
  served.service().reload([&] { return serve::Reread{{b, b}, {}}; });
  EXPECT_NE(served.log().find("a.toml: no TOML"), std::string::npos) << served.log();
  EXPECT_EQ(served.get("/collections").json().at("collections").size(), 2U);
  served.service().reload([&] { return serve::Reread{{{"a", b.path}}, {}}; });
  EXPECT_EQ(served.get("/collections/b").status, 404);
  EXPECT_EQ(served.get("/collections/a").status, 200);
}

TEST(ServeReload, HappensOnSighup) {
  const TestFolder folder;
  const serve::ServedFile a = hills_file(folder, "a"), b = hills_file(folder, "b");
  const std::string config = folder.file("serve.toml"), path = folder.file("s");
  const auto write_config = [&](const std::string& collections) {
    write_file(config, "listen = \"unix:" + path + "\"\n[collections]\n" + collections);
  };
  write_config("a = \"a.ptin\"\n");
  {
    const StartedPtin service({"serve", "--config", config});
    static_cast<void>(service.out_with("SIGTERM ends it"));
    const auto answers = [&](const char* target, const char* status) {
      return asked_at(path, target).starts_with(std::string("HTTP/1.1 ") + status);
    };
    EXPECT_TRUE(answers("/collections/b", "404"));
    write_config("a = \"a.ptin\"\nb = \"b.ptin\"\n");
    service.send(SIGHUP);
    EXPECT_TRUE(comes_true([&] { return answers("/collections/b", "200"); }));
    write_config("a = \"none.ptin\"\n");
    service.send(SIGHUP);
    EXPECT_TRUE(
        comes_true([&] { return service.err().find("\"refused\":") != std::string::npos; }));
    EXPECT_TRUE(answers("/collections/a", "200"));
    EXPECT_TRUE(answers("/collections/b", "200"));
    // Settings that are not heard are told, and a line that is no TOML by the file that has it.
    write_config("a = \"a.ptin\"\n[limits]\npoints = 7\n");
    service.send(SIGHUP);
    EXPECT_TRUE(comes_true([&] {
      return service.err().find(R"("collections":["a"],"from_next_start":["limits.points"])") !=
             std::string::npos;
    })) << service.err();
    write_config("broken [\n");
    service.send(SIGHUP);
    EXPECT_TRUE(comes_true([&] {
      return service.err().find(config + R"(: \"broken [\" cannot be the name)") !=
             std::string::npos;
    })) << service.err();
  }
  EXPECT_FALSE(fs::exists(path));  // After SIGTERM.
}

}  // namespace
}  // namespace ptin::tools::testing
