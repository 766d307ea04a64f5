// SPDX-License-Identifier: GPL-3.0-or-later
//
// The server against clients of all kinds: every limit, hang-ups, deadlines, draining.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/http_client.h"
#include "tests/tools/made_service.h"

namespace ptin::tools::testing {
namespace {

TEST(HttpServerConcurrency, AnswersOneAfterTheOther) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  for (int i = 0; i < 3; ++i) {
    const HttpAnswer answer = client.ask("POST", "/echo", "", "body " + std::to_string(i));
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, "POST body " + std::to_string(i));
    EXPECT_EQ(answer.header("x-made"), "yes");
    EXPECT_EQ(answer.header("connection"), "keep-alive");
  }
  EXPECT_EQ(client.get("/echo", "Connection: close\r\n").header("connection"), "close");
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(comes_true([&] { return service.noted == 4; }));
}

TEST(HttpServerConcurrency, AnswersWhatCameTogetherInItsOrder) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send(
      "GET /echo HTTP/1.1\r\nHost: a\r\n\r\nPOST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: "
      "3\r\n\r\ntwoGET /nothing HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive()->body, "GET ");
  EXPECT_EQ(client.receive()->body, "POST two");
  EXPECT_EQ(client.receive()->body, "answer");
}

TEST(HttpServerConcurrency, LeavesTheBodyOutForHead) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  const HttpAnswer head = client.ask("HEAD", "/nothing");
  EXPECT_EQ(head.header("content-length"), "6");
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(client.get("/nothing").body, "answer");
}

TEST(HttpServerConcurrency, TakesABodyInChunksAndAfterContinue) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send(
      "POST /echo HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n");
  EXPECT_EQ(client.receive()->body, "POST abc");
  client.send(
      "POST /echo HTTP/1.1\r\nHost: a\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n");
  client.send("hi");
  EXPECT_EQ(client.receive()->body, "POST hi");
}

/// A proxy before the server might end such a body elsewhere, and take the rest for a request.
TEST(HttpServerConcurrency, RefusesBodiesWhoseEndIsNotCertain) {
  MadeService service;
  RunningServer running(small_limits(), service);
  const std::string smuggled = "GET /nothing HTTP/1.1\r\nHost: a\r\n\r\n";
  for (const char* head : {"POST /echo HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: xchunked\r\n\r\n",
                           "POST /echo HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: gzip\r\n\r\n",
                           "POST /echo HTTP/1.0\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n",
                           "POST /echo HTTP/1.1\r\nContent-Length: 0\r\n\r\n"}) {
    HttpClient client(running.address());
    client.send(head + smuggled);
    const auto answer = client.receive();
    ASSERT_TRUE(answer) << head;
    EXPECT_GE(answer->status, 400) << head;
    EXPECT_FALSE(client.receive()) << head;
  }
}

TEST(HttpServerConcurrency, SeesAHangUpBehindBytesThatWait) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send("GET /wait HTTP/1.1\r\nHost: a\r\n\r\nGET /wait HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(comes_true([&] { return service.waiting > 0; }));
  client.close();
  EXPECT_TRUE(comes_true([&] { return service.stopped > 0; }));
}

struct TooMuch {
  const char* what;
  std::string request;
  int status;
  const char* limit;
};

TEST(HttpServerConcurrency, RefusesWhatIsTooLarge) {
  MadeService service;
  Limits limits = small_limits();
  limits.request_line_bytes = std::size_t{8} << 10;
  RunningServer running(limits, service);
  const std::string long_text(20000, 'a');
  const TooMuch all[] = {
      {"a line that ends", "GET /" + std::string(9000, 'a') + " HTTP/1.1\r\nHost: a\r\n\r\n", 414,
       "request_line_bytes"},
      {"a line that does not end", "GET /" + long_text + long_text, 414, "request_line_bytes"},
      {"one header", "GET / HTTP/1.1\r\nX: " + long_text + "\r\n\r\n", 431, "header_bytes"},
      {"a header that just fits the sum",
       "GET / HTTP/1.1\r\nX: " + std::string(9000, 'a') + "\r\n\r\n", 431, "header_bytes"},
      {"a body that is told", "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: 9000000\r\n\r\n",
       413, "body_bytes"}};
  for (const TooMuch& one : all) {
    SCOPED_TRACE(one.what);
    HttpClient client(running.address());
    client.send(one.request);
    const auto answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, one.status) << answer->body;
    EXPECT_EQ(answer->json()["limit"], one.limit);
    EXPECT_EQ(answer->header("content-type"), "application/problem+json");
    EXPECT_TRUE(client.is_closed());
  }
}

TEST(HttpServerConcurrency, RefusesABodyInChunksThatGrowsTooLarge) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send("POST /echo HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (int i = 0; i < 40; ++i) client.send("8000\r\n" + std::string(0x8000, 'b') + "\r\n");
  const auto answer = client.receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 413);
}

TEST(HttpServerConcurrency, RefusesWhatIsNoHttp) {
  MadeService service;
  RunningServer running(small_limits(), service);
  for (const std::string& garbage :
       {std::string("hello\r\n\r\n"), std::string("GET  / HTTP/1.1\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nab"),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) + std::string(300, 'x')}) {
    HttpClient client(running.address());
    client.send(garbage);
    const auto answer = client.receive();
    ASSERT_TRUE(answer) << garbage;
    EXPECT_EQ(answer->status, 400) << garbage;
  }
  HttpClient client(running.address());
  EXPECT_EQ(client.get("/%zz").status, 400);
  EXPECT_EQ(client.get("/%00").status, 400);
  EXPECT_EQ(client.get("/?a=%ff").status, 400);
  EXPECT_EQ(client.get("/nothing").status, 200);
}

TEST(HttpServerConcurrency, DoesNotWaitForSlowRequests) {
  MadeService service;
  Limits limits = small_limits();
  limits.reading = milliseconds(200);
  RunningServer running(limits, service);
  const HttpAnswer late = first_answer(running.address(), 408, "GET /echo HT");
  EXPECT_EQ(late.json()["limit"], "reading");
  const std::string body = "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nab";
  EXPECT_EQ(first_answer(running.address(), 408, body).json()["limit"], "reading");
  HttpClient silent(running.address());
  EXPECT_TRUE(silent.is_closed());
}

/// Each byte in time makes the whole no longer.
TEST(HttpServerConcurrency, DoesNotWaitForAHeadThatNeverEnds) {
  MadeService service;
  Limits limits = small_limits();
  limits.reading = milliseconds(200);
  RunningServer running(limits, service);
  HttpClient head(running.address());
  EXPECT_TRUE(comes_true([&] {
    head.send("G");
    return head.is_readable_within(milliseconds(20));
  }));
}

TEST(HttpServerConcurrency, StopsAQuestionWhoseClientLeft) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  client.send("GET /wait HTTP/1.1\r\nHost: a\r\n\r\n");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  client.close();
  EXPECT_TRUE(comes_true([&] { return service.stopped == 1; }));
  EXPECT_TRUE(comes_true([&] { return service.hung_up == 1; }));
  HttpClient next(running.address());
  EXPECT_EQ(next.get("/nothing").status, 200);
}

TEST(HttpServerConcurrency, StopsAQuestionThatTakesTooLong) {
  MadeService service;
  Limits limits = small_limits();
  limits.computing = milliseconds(100);
  RunningServer running(limits, service);
  HttpClient client(running.address());
  EXPECT_EQ(client.get("/wait").status, 503);
  EXPECT_EQ(service.last_given_up, GivenUp::kDeadline);
  EXPECT_TRUE(comes_true([&] { return client.get("/nothing").status == 200; }));
}

TEST(HttpServerConcurrency, QueuesNoMoreThanItSays) {
  MadeService service;
  RunningServer running(small_limits(), service);
  std::vector<std::unique_ptr<HttpClient>> clients;
  for (int i = 0; i < 2; ++i) {
    clients.push_back(std::make_unique<HttpClient>(running.address()));
    clients.back()->send("GET /wait HTTP/1.1\r\nHost: a\r\n\r\n");
  }
  ASSERT_TRUE(comes_true([&] { return service.waiting == 2; }));
  clients.push_back(std::make_unique<HttpClient>(running.address()));
  clients.back()->send("GET /wait HTTP/1.1\r\nHost: a\r\n\r\n");
  HttpClient quick(running.address());
  EXPECT_EQ(quick.get("/quick").body, "quick");  // By now the third one waits.
  HttpClient refused(running.address());
  const HttpAnswer answer = refused.get("/wait");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "waiting");
  EXPECT_EQ(answer.header("retry-after"), "1");
  service.is_released = true;
  for (const auto& client : clients) EXPECT_EQ(client->receive()->body, "answer");
}

TEST(HttpServerConcurrency, LetsGoOfAClientThatDoesNotRead) {
  MadeService service;
  Limits limits = small_limits();
  limits.writing = milliseconds(300);
  RunningServer running(limits, service);
  HttpClient client(running.address());
  client.shrink_receiving();
  client.send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(comes_true([&] { return service.cut == 1; }));
  HttpClient next(running.address());
  EXPECT_EQ(next.get("/nothing").status, 200);
}

TEST(HttpServerConcurrency, SendsLargeAnswersWhole) {
  const std::string whole(std::size_t{64} << 20, 'x');
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  EXPECT_TRUE(client.get("/large").body == whole);  // Not to be printed.
}

TEST(HttpServerConcurrency, AnswersFaultsAndGoesOn) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient client(running.address());
  EXPECT_EQ(client.get("/fault").status, 500);
  EXPECT_EQ(client.get("/nothing").status, 200);
}

TEST(HttpServerConcurrency, FinishesWhatIsAtHandWhenItDrains) {
  MadeService service;
  RunningServer running(small_limits(), service);
  HttpClient idle(running.address());
  EXPECT_EQ(idle.get("/nothing").status, 200);
  HttpClient busy(running.address());
  busy.send("GET /wait HTTP/1.1\r\nHost: a\r\n\r\n");
  ASSERT_TRUE(comes_true([&] { return service.waiting == 1; }));
  running.server().drain();
  EXPECT_TRUE(idle.is_closed());
  EXPECT_THROW(HttpClient(running.address()).get("/nothing"), std::runtime_error);
  service.is_released = true;
  const auto last = busy.receive();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->body, "answer");
  EXPECT_EQ(last->header("connection"), "close");
  running.stop();
}

TEST(HttpServer, RefusesAddressesThatAreNone) {
  MadeService service;
  for (const char* address : {"", "8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", "host:80",
                              "127.0.0.1:80a", "[::1:80"}) {
    EXPECT_THROW(http::Server(address, small_limits(), service), Error) << address;
  }
  RunningServer running(small_limits(), service);
  EXPECT_THROW(http::Server(running.address(), small_limits(), service), Error);
}

}  // namespace
}  // namespace ptin::tools::testing
