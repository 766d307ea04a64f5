// SPDX-License-Identifier: GPL-3.0-or-later
//
// One connection against clients that no limit of the whole server stops: bytes that come at the wrong
// moment, too slowly, in too many pieces.
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/http_client.h"
#include "tests/tools/made_service.h"

namespace ptin::tools::testing {
namespace {

constexpr const char* kChunked =
    "POST /echo HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n";

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// Keeps the thread of connections from its work until it is released, so that much happens at once.
class HoldingService : public MadeService {
 public:
  Response answer_quickly(const Request& request) override {
    if (request.path.size() < 2) return text("quick");
    ++waiting;
    while (!is_released) std::this_thread::sleep_for(milliseconds(1));
    return text("held");
  }
};

/// Connections that are accepted close others, whose requests have just arrived.
TEST(HttpConnectionConcurrency, ClosesForAnotherWhileItsRequestArrives) {
  constexpr const char* kQuick = "GET /quick HTTP/1.1\r\nHost: a\r\n\r\n";
  HoldingService service;
  RunningServer running(small_limits(), service);
  constexpr int kOthers = 5;  // Beside one, they are all that one address may have.
  std::vector<std::unique_ptr<HttpClient>> idle, fresh;
  for (int i = 0; i < kOthers; ++i) {
    idle.push_back(std::make_unique<HttpClient>(running.address()));
    EXPECT_EQ(idle.back()->get("/quick").status, 200);
  }
  HttpClient holds(running.address());
  holds.send("GET /quick/hold HTTP/1.1\r\nHost: a\r\n\r\n");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  for (const auto& client : idle) client->send(kQuick);
  for (int i = 0; i < kOthers; ++i) {
    fresh.push_back(std::make_unique<HttpClient>(running.address()));
    fresh.back()->send(kQuick);
  }
  service.is_released = true;
  EXPECT_EQ(fresh.back()->receive()->body, "quick");
}

TEST(HttpConnectionConcurrency, AnswersAnyNumberOfRequestsThatComeTogether) {
  constexpr int kRequests = 3000;
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send(repeated("GET /quick HTTP/1.1\r\nHost: a\r\n\r\n", kRequests));
  for (int i = 0; i < kRequests; ++i) ASSERT_EQ(client.receive()->body, "quick") << i;
}

/// The deadline passes while there is something to read, each time that it is looked at.
TEST(HttpConnectionConcurrency, DoesNotWaitForABodyThatNeverPauses) {
  MadeService service;
  Limits limits = small_limits();
  limits.reading = milliseconds(200);
  limits.body_bytes = std::size_t{1} << 30;
  limits.memory_bytes = std::uint64_t{8} << 30;
  RunningServer running(limits, service);
  const std::string chunks = repeated("1\r\nx\r\n", 1000);
  HttpClient client(running.address());
  client.send(kChunked);
  EXPECT_TRUE(comes_true([&] {
    client.send(chunks);
    return client.is_readable_within(milliseconds(0));
  }));
  const auto answer = client.receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 408);
  EXPECT_EQ(answer->json()["limit"], "reading");
}

TEST(HttpConnectionConcurrency, RefusesChunksWithMoreBesideThemThanAHeadHas) {
  MadeService service;
  const Limits limits = small_limits();
  RunningServer running(limits, service);
  const std::string long_text(limits.header_bytes + 100, 'e');
  for (const std::string& body :
       {"1;" + long_text + "\r\nx\r\n0\r\n\r\n", "0\r\nX: " + long_text + "\r\n\r\n",
        repeated("1;" + std::string(100, 'e') + "\r\nx\r\n", 200) + "0\r\n\r\n"}) {
    HttpClient client(running.address());
    client.send(kChunked + body);
    const auto answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 431);
    EXPECT_EQ(answer->json()["limit"], "header_bytes");
  }
}

TEST(HttpConnectionConcurrency, TakesABodyInManyChunksWithAWordBesideThem) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send(kChunked + repeated("1\r\nx\r\n", 5000) + "1;a=b\r\ny\r\n0\r\nX: trailer\r\n\r\n");
  EXPECT_EQ(client.receive()->body, "POST " + std::string(5000, 'x') + "y");
}

TEST(HttpConnectionConcurrency, IgnoresEmptyLinesBeforeARequest) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send(
      "\r\nPOST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: 3\r\n\r\ntwo\r\nGET /quick "
      "HTTP/1.1\r\nHost: a\r\n\r\n\r");
  EXPECT_EQ(client.receive()->body, "POST two");
  EXPECT_EQ(client.receive()->body, "quick");
  client.send("\nGET /quick HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive()->body, "quick");
}

TEST(HttpConnectionConcurrency, IgnoresAnExpectationOfTheVersionThatHasNone) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send("POST /echo HTTP/1.0\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n");
  EXPECT_FALSE(client.is_readable_within(milliseconds(50)));
  client.send("hi");
  EXPECT_EQ(client.receive()->body, "POST hi");
}

TEST(HttpConnectionConcurrency, TellsWhatItDoesNotSpeak) {
  MadeService service;
  RunningServer running(small_limits(), service);
  const auto status_of = [&](const std::string& request) {
    HttpClient client(running.address());
    client.send(request);
    const auto answer = client.receive();
    return answer ? answer->status : 0;
  };
  EXPECT_EQ(status_of("GET / HTTP/2.0\r\nHost: a\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTP/1.2\r\nHost: a\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTX/1.1\r\nHost: a\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET HTTP://a/quick HTTP/1.1\r\nHost: a\r\n\r\n"), 200);
  EXPECT_EQ(status_of("OPTIONS * HTTP/1.1\r\nHost: a\r\n\r\n"), 200);
  EXPECT_EQ(status_of("GET * HTTP/1.1\r\nHost: a\r\n\r\n"), 400);
  const std::string packed =
      "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Encoding: gzip\r\nContent-Length: 3\r\n\r\nabc";
  EXPECT_EQ(status_of(packed), 415);
}

}  // namespace
}  // namespace ptin::tools::testing
