// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shares that one client cannot take from the others: memory of answers and of bodies, connections.
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/http_client.h"
#include "tests/tools/made_service.h"

namespace ptin::tools::testing {
namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

/// Answers /large with many bytes for which memory is held, all else at once. Points take memory, too.
class LendingService : public MadeService {
 public:
  http::Needs needs(const Request& request) const override {
    const http::Lane lane = MadeService::needs(request).lane;
    return {lane, lane == http::Lane::kPoint ? kMebibyte : 2 * kMebibyte};
  }
  Response answer(const Request& request) override {
    if (request.path[0] != "large") return MadeService::answer(request);
    Response response = text(std::string(kMebibyte, 'x'));
    request.memory->shrink_to(response.body.capacity());
    response.held = request.memory;
    return response;
  }
  void rest() noexcept override { ++rests; }

  std::atomic<int> rests{0};
};

/// As behind a proxy that is trusted.
std::string from(int client) {
  return "X-Forwarded-For: 192.0.2." + std::to_string(client) + "\r\n";
}

class HttpSharesConcurrency : public ::testing::Test {
 protected:
  using Clients = std::vector<std::unique_ptr<HttpClient>>;

  HttpSharesConcurrency() {
    limits.connections = 200;
    limits.waiting = 100;
    limits.memory_bytes = 8 * kMebibyte;
    limits.body_bytes = kMebibyte / 4;
    limits.trusted_proxies = {http::parse_network("127.0.0.1")};
  }
  std::unique_ptr<HttpClient> connected() {
    if (!running) running.emplace(limits, service);
    return std::make_unique<HttpClient>(running->address());
  }

  LendingService service;
  Limits limits = small_limits();
  std::optional<RunningServer> running;
};

TEST_F(HttpSharesConcurrency, KeepMemoryForOthersBesideAnswersThatNobodyReads) {
  limits.point_bytes = kMebibyte;
  limits.question_bytes = 2 * kMebibyte;
  Clients slow;
  for (int i = 0; i < 40; ++i) {
    slow.push_back(connected());
    slow.back()->shrink_receiving();
    slow.back()->send("GET /large/sweep HTTP/1.1\r\nHost: a\r\n" + from(i % 20) + "\r\n");
  }
  for (const auto& client : slow) {
    ASSERT_TRUE(comes_true([&] { return client->is_readable_within(milliseconds(10)); }));
  }
  EXPECT_EQ(connected()->get("/height", from(100)).status, 200);
  EXPECT_EQ(connected()->get("/small/sweep", from(101)).status, 200);
  const HttpAnswer large = connected()->get("/large/sweep", from(0));
  EXPECT_EQ(large.status, 503);
  EXPECT_EQ(large.json()["limit"], "memory_bytes");
}

TEST_F(HttpSharesConcurrency, KeepMemoryForBodiesOfOthers) {
  Clients unfinished;
  for (int i = 0; i < 30; ++i) {
    unfinished.push_back(connected());
    unfinished.back()->send("POST /echo HTTP/1.1\r\nHost: a\r\n" + from(1) +
                            "Content-Length: 250000\r\n\r\n" + std::string(249999, 'x'));
  }
  const std::string body(20000, 'y');
  EXPECT_EQ(connected()->ask("POST", "/echo", from(2), body).body, "POST " + body);
}

TEST_F(HttpSharesConcurrency, GiveMemoryOfBodiesBackToTheSystem) {
  EXPECT_EQ(connected()->ask("POST", "/echo", from(1), std::string(200000, 'x')).status, 200);
  EXPECT_TRUE(comes_true([&] { return service.rests > 0; }));
}

TEST_F(HttpSharesConcurrency, KeepAConnectionForOthersHoweverFewThereAre) {
  limits.trusted_proxies.clear();
  for (const std::size_t connections : {1, 2, 3, 4, 5, 7, 8}) {
    SCOPED_TRACE(connections);
    limits.connections = connections;
    RunningServer few(limits, service);
    Clients idle;
    for (int i = 0; i < 10; ++i) {
      idle.push_back(std::make_unique<HttpClient>(few.address(), "127.0.0.2"));
    }
    for (int i = 0; i < 3; ++i) {  // Each after the other, the one before just closed.
      HttpClient client(few.address(), "127.0.0.99");
      client.send("GET /nothing HTTP/1.0\r\n\r\n");
      const auto answer = client.receive();
      ASSERT_TRUE(answer);
      EXPECT_EQ(answer->status, 200);
    }
  }
}

}  // namespace
}  // namespace ptin::tools::testing
