// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who is let in: lanes, turns, memory, connections, bodies, and what stands outside of all of it.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/http_client.h"
#include "tests/tools/made_service.h"

namespace ptin::tools::testing {
namespace {

/// A service whose questions go on until they are released, and a server of it that a test sizes
/// before it asks: room for connections, unless the test is about them.
class HttpAdmissionConcurrency : public ::testing::Test {
 protected:
  using Clients = std::vector<std::unique_ptr<HttpClient>>;

  HttpAdmissionConcurrency() { limits.connections = 100; }
  ~HttpAdmissionConcurrency() override { service.is_released = true; }

  /// The server, which is started by the first that needs it.
  http::Server& server() { return running().server(); }
  const std::string& address() { return running().address(); }
  std::unique_ptr<HttpClient> connected() { return std::make_unique<HttpClient>(address()); }
  std::unique_ptr<HttpClient> sent(const std::string& target, const std::string& headers = {}) {
    auto client = connected();
    client->send("GET " + target + " HTTP/1.1\r\nHost: a\r\n" + headers + "\r\n");
    return client;
  }
  /// Sends so many; where some of them are to be computed, waits until they are, and sends others in
  /// the place of those that were refused for a short deadline.
  Clients sent(int number, const std::string& target, int computed = 0) {
    Clients clients;
    for (int i = 0; i < number; ++i) clients.push_back(sent(target));
    EXPECT_TRUE(comes_true([&] {
      for (auto& client : clients) {
        if (computed > 0 && client->is_readable_within(milliseconds(0))) client = sent(target);
      }
      return service.waiting >= computed;
    }));
    return clients;
  }
  int status_of(const std::string& target, const std::string& headers = {}) {
    return connected()->get(target, headers).status;
  }
  /// By now the server has read all that was sent before.
  void expect_quick() { EXPECT_EQ(status_of("/quick"), 200); }
  void expect_all_answered(const Clients& clients) {
    service.is_released = true;
    for (const auto& client : clients) EXPECT_EQ(client->receive()->status, 200);
  }

  MadeService service;
  Limits limits = small_limits();

 private:
  RunningServer& running() {
    if (!running_) running_.emplace(limits, service);
    return *running_;
  }
  std::optional<RunningServer> running_;
};

std::string post_of(std::size_t bytes, const std::string& body = {}) {
  return "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: " + std::to_string(bytes) + "\r\n\r\n" +
         body;
}

TEST_F(HttpAdmissionConcurrency, LetsCheapQuestionsPassDearOnes) {
  limits.waiting = 4;
  const Clients sweeps = sent(6, "/wait/sweep", 2);
  EXPECT_EQ(status_of("/nothing"), 200);
  EXPECT_EQ(status_of("/nothing/tile"), 200);  // The third thread for tiles and sweeps.
  expect_quick();
  EXPECT_EQ(service.waiting, 2);
  expect_all_answered(sweeps);
}

TEST_F(HttpAdmissionConcurrency, LetsSweepsGoOnBesideTiles) {
  const Clients tiles = sent(2, "/wait/tile", 2);
  EXPECT_EQ(status_of("/nothing/sweep"), 200);
}

TEST_F(HttpAdmissionConcurrency, LetsQuestionsWaitForMemory) {
  service.sweep_bytes = 600;
  limits.memory_bytes = 1000;
  limits.waiting = 8;
  const Clients sweeps = sent(3, "/wait/sweep", 1);
  EXPECT_EQ(status_of("/nothing"), 200);
  EXPECT_EQ(service.waiting, 1);  // The second thread has no memory for another one.
  expect_all_answered(sweeps);
}

TEST_F(HttpAdmissionConcurrency, LendsNothingOfWhatIsKept) {
  service.sweep_bytes = 600;
  limits.memory_bytes = 1000;
  limits.kept_bytes = 400;
  EXPECT_EQ(status_of("/nothing/sweep"), 200);
  service.sweep_bytes = 601;
  const HttpAnswer answer = connected()->get("/nothing/sweep");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "memory_bytes");
}

TEST_F(HttpAdmissionConcurrency, BoundsWhatIsKeptWheneverQuestionsHadHalfOfIt) {
  service.sweep_bytes = 100;
  limits.memory_bytes = 2000;
  limits.kept_bytes = 800;
  for (int i = 1; i <= 9; ++i) {
    EXPECT_EQ(status_of("/nothing/sweep"), 200);
    EXPECT_TRUE(comes_true([&] { return service.bounded == i / 4; })) << i;
  }
}

TEST_F(HttpAdmissionConcurrency, TellsWhoWaitedForATurnInVain) {
  service.sweep_bytes = 600;
  limits.memory_bytes = 2000;
  limits.waiting = 8;
  limits.queueing = milliseconds(100);
  const Clients sweeps = sent(2, "/wait/sweep", 2);
  const HttpAnswer answer = connected()->get("/nothing/sweep");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "queueing");
  EXPECT_EQ(answer.header("retry-after"), "1");
  EXPECT_TRUE(comes_true([&] { return status_of("/nothing") == 200; }));
}

/// Threads are free: it is memory that the next one lacks, and with it those of its client behind it.
TEST_F(HttpAdmissionConcurrency, TellsWhoWaitedForMemoryInVain) {
  service.sweep_bytes = 600;
  limits.threads = 3;
  limits.memory_bytes = 1000;
  limits.waiting = 8;
  limits.queueing = milliseconds(100);
  const Clients sweeps = sent(1, "/wait/sweep", 1);
  for (const auto& client : sent(3, "/nothing/sweep")) {
    const auto answer = client->receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 503);
    EXPECT_EQ(answer->json()["limit"], "memory_bytes") << answer->body;
    EXPECT_EQ(answer->header("retry-after"), "1");
  }
}

TEST_F(HttpAdmissionConcurrency, ComputesNothingForWhoLeftWhileWaiting) {
  const Clients sweeps = sent(2, "/wait/sweep", 2);
  for (int i = 0; i < 3; ++i) {  // One may wait: each has left before the next comes.
    const auto third = sent("/wait/sweep");
    expect_quick();
    third->close();
    ASSERT_TRUE(comes_true([&] { return service.hung_up == i + 1; }));
  }
}

/// Each client behind a trusted proxy has its turn, whoever asked more.
TEST_F(HttpAdmissionConcurrency, DisplacesWhoWaitsMostForWhoIsNew) {
  limits.threads = 1;
  limits.waiting = 3;
  limits.trusted_proxies = {http::parse_network("127.0.0.1")};
  const auto ask = [&](const std::string& who) {
    auto client = sent("/wait/sweep", "X-Forwarded-For: " + who + "\r\n");
    expect_quick();  // By now it stands in the line.
    return client;
  };
  const auto runs = ask("192.0.2.1");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  Clients many;
  for (int i = 0; i < 3; ++i) many.push_back(ask("192.0.2.1"));
  const auto other = ask("192.0.2.2");
  const auto displaced = many.back()->receive();
  ASSERT_TRUE(displaced);
  EXPECT_EQ(displaced->status, 503);
  EXPECT_EQ(displaced->json()["limit"], "waiting");
  service.is_released = true;
  EXPECT_EQ(other->receive()->status, 200);
  EXPECT_EQ(many.front()->receive()->status, 200);
}

TEST_F(HttpAdmissionConcurrency, ClosesTheLongestIdleConnectionForANewOne) {
  limits.connections = 8;
  Clients idle;
  for (int i = 0; i < 40; ++i) idle.push_back(connected());
  expect_quick();
  EXPECT_EQ(status_of("/nothing"), 200);
  EXPECT_TRUE(idle.front()->is_closed());
  EXPECT_EQ(idle.back()->get("/nothing").status, 200);
}

TEST_F(HttpAdmissionConcurrency, AnswersWhatIsQuickWhenNoConnectionIsIdle) {
  limits.connections = 8;
  limits.threads = 8;
  const Clients busy = sent(6, "/wait", 6);  // Three quarters.
  for (int i = 0; i < 40; ++i) expect_quick();
  const HttpAnswer answer = connected()->get("/nothing");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "connections");
  EXPECT_EQ(answer.header("connection"), "close");
  Clients silent;
  for (int i = 0; i < 40; ++i) silent.push_back(connected());
  expect_quick();
  expect_all_answered(busy);
}

TEST_F(HttpAdmissionConcurrency, LendsABodyWhatHasArrived) {
  limits.memory_bytes = 100000;
  limits.body_bytes = 20000;
  Clients heads;
  for (int i = 0; i < 20; ++i) {
    heads.push_back(connected());
    heads.back()->send(post_of(20000));
  }
  EXPECT_EQ(connected()->ask("POST", "/echo", "", "{}").body, "POST {}");
}

TEST_F(HttpAdmissionConcurrency, LetsBodiesWaitForMemory) {
  limits.memory_bytes = 40000;
  limits.body_bytes = 10000;
  Clients slow;
  for (int i = 0; i < 8; ++i) {
    slow.push_back(connected());
    slow.back()->send(post_of(10000, std::string(9999, 'x')));
  }
  const auto client = connected();
  client->send(post_of(10000, std::string(10000, 'y')));
  EXPECT_EQ(status_of("/nothing"), 200);
  slow.clear();
  EXPECT_EQ(client->receive()->body, "POST " + std::string(10000, 'y'));
}

TEST_F(HttpAdmissionConcurrency, TellsABodyThatWaitedInVain) {
  limits.memory_bytes = 4000;
  limits.body_bytes = 10000;
  limits.reading = milliseconds(200);
  const HttpAnswer answer = first_answer(address(), 503, post_of(9000, std::string(9000, 'x')));
  EXPECT_EQ(answer.json()["limit"], "memory_bytes");
}

TEST_F(HttpAdmissionConcurrency, RefusesBeforeTheBodyComes) {
  const auto large = connected();
  large->send("POST /forbidden HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\nx");
  EXPECT_EQ(large->receive()->status, 401);
  const auto small = connected();  // A short body is read, and the connection goes on.
  EXPECT_EQ(small->ask("POST", "/forbidden", "", "short").status, 401);
  EXPECT_EQ(small->ask("POST", "/echo", "", "more").body, "POST more");
}

TEST_F(HttpAdmissionConcurrency, KeepsNoMemoryOfWhatWasAnswered) {
  Clients idle;
  for (int i = 0; i < 5; ++i) {
    idle.push_back(connected());
    const std::string body(std::size_t{1} << 20, 'x');
    EXPECT_EQ(idle.back()->ask("POST", "/echo", "", body).body, "POST " + body);
  }
  EXPECT_TRUE(comes_true([&] { return service.noted == 5; }));
  EXPECT_TRUE(comes_true([&] { return server().load().memory_bytes == 0; }));
}

TEST_F(HttpAdmissionConcurrency, TellsWhoComesThatItEnds) {
  limits.draining = kUnhurried;
  const auto kept = connected();
  EXPECT_EQ(kept->get("/nothing").status, 200);
  server().drain();
  EXPECT_TRUE(comes_true([&] { return status_of("/nothing") == 503; }));
  expect_quick();
  const HttpAnswer last = kept->get("/nothing");
  EXPECT_EQ(last.status, 503);
  EXPECT_EQ(last.header("connection"), "close");
  // The end of the test drains a second time: at once.
}

TEST_F(HttpAdmissionConcurrency, SendsFilesWhileAPieceIsSlowToRead) {
  const auto file = sent("/file");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  expect_quick();
  EXPECT_EQ(status_of("/nothing"), 200);
  service.is_released = true;
  EXPECT_EQ(file->receive()->body, std::string(300000, 'f'));
}

TEST_F(HttpAdmissionConcurrency, NamesWhoConnects) {
  EXPECT_EQ(status_of("/nothing", "X-Forwarded-For: 192.0.2.7\r\n"), 200);
  EXPECT_TRUE(comes_true([&] { return service.last_remote() == "127.0.0.1"; }));
}

TEST_F(HttpAdmissionConcurrency, NamesTheClientOfATrustedProxy) {
  limits.trusted_proxies = {http::parse_network("127.0.0.0/8")};
  EXPECT_EQ(status_of("/nothing", "X-Forwarded-For: 9.9.9.9, 192.0.2.7, 127.0.0.3\r\n"), 200);
  EXPECT_TRUE(comes_true([&] { return service.last_remote() == "192.0.2.7"; }));
}

}  // namespace
}  // namespace ptin::tools::testing
