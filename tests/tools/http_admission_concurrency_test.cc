// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who is let in: lanes, turns, memory, connections, bodies, and what stands outside of all of it.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/http_client.h"
#include "tests/tools/made_service.h"

namespace ptin::tools::testing {
namespace {

std::unique_ptr<HttpClient> sent(const RunningServer& running, const std::string& target) {
  auto client = std::make_unique<HttpClient>(running.address());
  client->send("GET " + target + " HTTP/1.1\r\nHost: a\r\n\r\n");
  return client;
}

int status_of(const RunningServer& running, const std::string& target,
              const std::string& headers = {}) {
  HttpClient client(running.address());
  return client.get(target, headers).status;
}

TEST(HttpAdmissionConcurrency, LetsCheapQuestionsPassDearOnes) {
  MadeService service;
  Limits limits = small_limits();
  limits.waiting = 4;
  limits.connections = 100;
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> sweeps;
  for (int i = 0; i < 6; ++i) sweeps.push_back(sent(running, "/wait/sweep"));
  ASSERT_TRUE(comes_true([&] { return service.waiting == 2; }));
  EXPECT_EQ(status_of(running, "/nothing"), 200);
  EXPECT_EQ(status_of(running, "/nothing/tile"), 200);  // The third thread for tiles and sweeps.
  EXPECT_EQ(status_of(running, "/quick"), 200);
  EXPECT_EQ(service.waiting, 2);
  service.is_released = true;
  for (const auto& client : sweeps) EXPECT_EQ(client->receive()->status, 200);
}

TEST(HttpAdmissionConcurrency, LetsSweepsGoOnBesideTiles) {
  MadeService service;
  RunningServer running(small_limits(), service);
  const auto first = sent(running, "/wait/tile"), second = sent(running, "/wait/tile");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 2; }));
  EXPECT_EQ(status_of(running, "/nothing/sweep"), 200);
  service.is_released = true;
}

TEST(HttpAdmissionConcurrency, LetsQuestionsWaitForMemory) {
  MadeService service;
  service.sweep_bytes = 600;
  Limits limits = small_limits();
  limits.memory_bytes = 1000;
  limits.waiting = 8;
  limits.connections = 100;
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> sweeps;
  for (int i = 0; i < 3; ++i) sweeps.push_back(sent(running, "/wait/sweep"));
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  EXPECT_EQ(status_of(running, "/nothing"), 200);
  EXPECT_EQ(service.waiting, 1);  // The second thread has no memory for another one.
  service.is_released = true;
  for (const auto& client : sweeps) EXPECT_EQ(client->receive()->status, 200);
}

TEST(HttpAdmissionConcurrency, TellsWhoWaitedInVain) {
  MadeService service;
  Limits limits = small_limits();
  limits.queueing = milliseconds(100);
  RunningServer running(limits, service);
  const auto first = sent(running, "/wait/sweep"), second = sent(running, "/wait/sweep");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 2; }));
  HttpClient client(running.address());
  const HttpAnswer answer = client.get("/nothing/sweep");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "queueing");
  EXPECT_EQ(answer.header("retry-after"), "1");
  EXPECT_EQ(client.get("/nothing").status, 200);
  service.is_released = true;
}

TEST(HttpAdmissionConcurrency, ComputesNothingForWhoLeftWhileWaiting) {
  MadeService service;
  RunningServer running(small_limits(), service);
  const auto first = sent(running, "/wait/sweep"), second = sent(running, "/wait/sweep");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 2; }));
  for (int i = 0; i < 3; ++i) {  // One may wait: each has left before the next comes.
    const auto third = sent(running, "/wait/sweep");
    EXPECT_EQ(status_of(running, "/quick"), 200);
    third->close();
    ASSERT_TRUE(comes_true([&] { return service.hung_up == i + 1; }));
  }
  service.is_released = true;
}

/// Each client behind a trusted proxy has its turn, whoever asked more.
TEST(HttpAdmissionConcurrency, DisplacesWhoWaitsMostForWhoIsNew) {
  MadeService service;
  Limits limits = small_limits();
  limits.threads = 1;
  limits.waiting = 3;
  limits.connections = 100;
  limits.trusted_proxies = {http::parse_network("127.0.0.1")};
  RunningServer running(limits, service);
  const auto ask = [&](const char* who) {
    auto client = std::make_unique<HttpClient>(running.address());
    client->send(std::string("GET /wait/sweep HTTP/1.1\r\nHost: a\r\nX-Forwarded-For: ") + who +
                 "\r\n\r\n");
    EXPECT_EQ(status_of(running, "/quick"), 200);  // By now it stands in the line.
    return client;
  };
  const auto runs = ask("192.0.2.1");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  std::vector<std::unique_ptr<HttpClient>> many;
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

TEST(HttpAdmissionConcurrency, ClosesTheLongestIdleConnectionForANewOne) {
  MadeService service;
  Limits limits = small_limits();
  limits.reading = limits.idle = milliseconds(20000);
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> idle;
  for (int i = 0; i < 40; ++i) idle.push_back(std::make_unique<HttpClient>(running.address()));
  EXPECT_EQ(status_of(running, "/quick"), 200);
  EXPECT_EQ(status_of(running, "/nothing"), 200);
  EXPECT_TRUE(idle.front()->is_closed_within(milliseconds(5000)));
  EXPECT_EQ(idle.back()->get("/nothing").status, 200);
}

TEST(HttpAdmissionConcurrency, AnswersWhatIsQuickWhenNoConnectionIsIdle) {
  MadeService service;
  Limits limits = small_limits();
  limits.threads = 8;
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> busy;
  for (int i = 0; i < 6; ++i) busy.push_back(sent(running, "/wait"));  // Three quarters.
  ASSERT_TRUE(comes_true([&] { return service.waiting == 6; }));
  for (int i = 0; i < 40; ++i) ASSERT_EQ(status_of(running, "/quick"), 200);
  HttpClient refused(running.address());
  const HttpAnswer answer = refused.get("/nothing");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "connections");
  EXPECT_EQ(answer.header("connection"), "close");
  std::vector<std::unique_ptr<HttpClient>> silent;
  for (int i = 0; i < 40; ++i) silent.push_back(std::make_unique<HttpClient>(running.address()));
  EXPECT_EQ(status_of(running, "/quick"), 200);
  service.is_released = true;
  for (const auto& client : busy) EXPECT_EQ(client->receive()->status, 200);
}

TEST(HttpAdmissionConcurrency, LendsABodyWhatHasArrived) {
  MadeService service;
  Limits limits = small_limits();
  limits.connections = 100;
  limits.memory_bytes = 100000;
  limits.body_bytes = 20000;
  limits.reading = milliseconds(20000);
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> heads;
  for (int i = 0; i < 20; ++i) {
    heads.push_back(std::make_unique<HttpClient>(running.address()));
    heads.back()->send("POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: 20000\r\n\r\n");
  }
  HttpClient client(running.address());
  EXPECT_EQ(client.ask("POST", "/echo", "", "{}").body, "POST {}");
}

TEST(HttpAdmissionConcurrency, LetsBodiesWaitForMemory) {
  MadeService service;
  Limits limits = small_limits();
  limits.connections = 100;
  limits.memory_bytes = 40000;
  limits.body_bytes = 10000;
  limits.reading = milliseconds(20000);
  RunningServer running(limits, service);
  const std::string head = "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: 10000\r\n\r\n";
  std::vector<std::unique_ptr<HttpClient>> slow;
  for (int i = 0; i < 8; ++i) {
    slow.push_back(std::make_unique<HttpClient>(running.address()));
    slow.back()->send(head + std::string(9999, 'x'));
  }
  HttpClient client(running.address());
  client.send(head + std::string(10000, 'y'));
  EXPECT_EQ(status_of(running, "/nothing"), 200);
  slow.clear();
  EXPECT_EQ(client.receive()->body, "POST " + std::string(10000, 'y'));
}

TEST(HttpAdmissionConcurrency, TellsABodyThatWaitedInVain) {
  MadeService service;
  Limits limits = small_limits();
  limits.memory_bytes = 4000;
  limits.body_bytes = 10000;
  limits.reading = milliseconds(200);
  RunningServer running(limits, service);
  HttpClient client(running.address());
  const HttpAnswer answer = client.ask("POST", "/echo", "", std::string(9000, 'x'));
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "memory_bytes");
}

TEST(HttpAdmissionConcurrency, RefusesBeforeTheBodyComes) {
  MadeService service;
  Limits limits = small_limits();
  limits.reading = milliseconds(20000);
  RunningServer running(limits, service);
  HttpClient large(running.address());
  large.send("POST /forbidden HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\nx");
  EXPECT_EQ(large.receive()->status, 401);
  HttpClient small(running.address());  // A short body is read, and the connection goes on.
  EXPECT_EQ(small.ask("POST", "/forbidden", "", "short").status, 401);
  EXPECT_EQ(small.ask("POST", "/echo", "", "more").body, "POST more");
}

TEST(HttpAdmissionConcurrency, KeepsNoMemoryOfWhatWasAnswered) {
  MadeService service;
  Limits limits = small_limits();
  limits.idle = milliseconds(20000);
  RunningServer running(limits, service);
  std::vector<std::unique_ptr<HttpClient>> idle;
  for (int i = 0; i < 5; ++i) {
    idle.push_back(std::make_unique<HttpClient>(running.address()));
    const std::string body(std::size_t{1} << 20, 'x');
    EXPECT_EQ(idle.back()->ask("POST", "/echo", "", body).body, "POST " + body);
  }
  EXPECT_TRUE(comes_true([&] { return service.noted == 5; }));
  EXPECT_TRUE(comes_true([&] { return running.server().load().memory_bytes == 0; }));
}

TEST(HttpAdmissionConcurrency, TellsWhoComesThatItEnds) {
  MadeService service;
  Limits limits = small_limits();
  limits.draining = milliseconds(20000);
  RunningServer running(limits, service);
  HttpClient kept(running.address());
  EXPECT_EQ(kept.get("/nothing").status, 200);
  running.server().drain();
  EXPECT_TRUE(comes_true([&] { return status_of(running, "/nothing") == 503; }));
  EXPECT_EQ(status_of(running, "/quick"), 200);
  const HttpAnswer last = kept.get("/nothing");
  EXPECT_EQ(last.status, 503);
  EXPECT_EQ(last.header("connection"), "close");
  running.stop();  // A second time: at once.
}

TEST(HttpAdmissionConcurrency, SendsFilesWhileAPieceIsSlowToRead) {
  MadeService service;
  Limits limits = small_limits();
  limits.writing = milliseconds(20000);
  RunningServer running(limits, service);
  const auto file = sent(running, "/file");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  EXPECT_EQ(status_of(running, "/quick"), 200);
  EXPECT_EQ(status_of(running, "/nothing"), 200);
  service.is_released = true;
  EXPECT_EQ(file->receive()->body, std::string(300000, 'f'));
}

TEST(HttpAdmissionConcurrency, NamesTheClientOfATrustedProxyAlone) {
  MadeService service;
  Limits limits = small_limits();
  RunningServer plain(limits, service);
  EXPECT_EQ(status_of(plain, "/nothing", "X-Forwarded-For: 192.0.2.7\r\n"), 200);
  EXPECT_TRUE(comes_true([&] { return service.last_remote() == "127.0.0.1"; }));
  limits.trusted_proxies = {http::parse_network("127.0.0.0/8")};
  RunningServer behind(limits, service);
  EXPECT_EQ(status_of(behind, "/nothing", "X-Forwarded-For: 9.9.9.9, 192.0.2.7, 127.0.0.3\r\n"),
            200);
  EXPECT_TRUE(comes_true([&] { return service.last_remote() == "192.0.2.7"; }));
}

}  // namespace
}  // namespace ptin::tools::testing
