// SPDX-License-Identifier: GPL-3.0-or-later
//
// JSON, forms and queries that nobody means well with: each is read in one pass, or refused.
#include "tools/serve/client_json.h"

#include <optional>
#include <stop_token>
#include <string>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tools/http/problem.h"
#include "tools/serve/question.h"

namespace ptin::serve {
namespace {

std::string times(std::size_t n, const std::string& text, const std::string& between = ",") {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) all.append(i == 0 ? "" : between).append(text);
  return all;
}

/// The status of the refusal; 200 where there is none.
unsigned status_of(const std::string& text, const JsonBounds& bounds = {}) {
  try {
    static_cast<void>(json_of_client(text, "body", bounds));
    return 200;
  } catch (const http::Problem& problem) {
    EXPECT_LT(problem.detail().size(), 300U);
    return problem.status();
  }
}

TEST(ClientJson, IsWhatTheLibraryReads) {
  for (const char* text :
       {"[]", "{}", "null", "-1.5e3", "[1,[2,{\"a\":[true,false,null]}],\"\\u00e9\"]",
        R"({"a":{"b":{"c":[1,2,3]}},"d":18446744073709551615,"e":-3})"}) {
    EXPECT_EQ(json_of_client(text, "body"), nlohmann::json::parse(text)) << text;
  }
  for (const char* text : {"", "[1,", "{\"a\":}", "[1]]", "nul", "\"\xff\"", "{1:2}"}) {
    EXPECT_EQ(status_of(text), 400U) << text;
  }
}

TEST(ClientJson, TellsOfANumberBeyondAllThatThereAre) {
  for (const std::string& text : {std::string("[1e400]"), std::string(1000, '9')}) {
    try {
      static_cast<void>(json_of_client(text, "body"));
      ADD_FAILURE() << text;
    } catch (const http::Problem& problem) {
      EXPECT_EQ(problem.status(), 400U);
      EXPECT_NE(problem.detail().find("number"), std::string::npos) << problem.detail();
    }
  }
}

TEST(ClientJson, IsNoDeeperThanItsBounds) {
  EXPECT_EQ(status_of(std::string(16, '[') + std::string(16, ']')), 200U);
  EXPECT_EQ(status_of(std::string(17, '[') + std::string(17, ']')), 400U);
  EXPECT_EQ(status_of(std::string(1000000, '[')), 400U);
  EXPECT_EQ(status_of("{\"a\":" + std::string(100000, '{')), 400U);
}

TEST(ClientJson, HasNoMemberTwice) {
  EXPECT_EQ(status_of(R"({"a":1,"a":2})"), 400U);
  EXPECT_EQ(status_of(R"([{"a":{"b":1,"b":2}}])"), 400U);
  EXPECT_EQ(status_of(R"({"a":{"a":1},"b":{"a":1}})"), 200U);
}

/// A megabyte of the smallest values: each takes up to kBytesOfValue.
TEST(ClientJson, TakesNoMoreThanItsMemory) {
  JsonBounds bounds;
  bounds.memory_bytes = std::uint64_t{8} << 20;
  for (const std::string& text :
       {"[" + times(349000, "{}") + "]", "[" + times(349000, "[]") + "]",
        "[" + times(500000, "0") + "]", "[" + times(170000, "{\"\":0}") + "]"}) {
    EXPECT_EQ(status_of(text, bounds), 413U) << text.substr(0, 20);
  }
  EXPECT_EQ(status_of("[" + times(60000, "[]") + "]", bounds), 200U);
}

TEST(ClientJson, IsReadNoFurtherThanSomebodyWaits) {
  std::stop_source stop;
  stop.request_stop();
  JsonBounds bounds;
  bounds.stop = stop.get_token();
  try {
    static_cast<void>(json_of_client("[" + times(100000, "{}") + "]", "body", bounds));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST(ClientJson, IsReadOnceWhateverItsShape) {
  for (const std::string& text :
       {"{\"pairs\":[" + times(100000, "{}") + ",1]}", std::string(1000000, '1'),
        "\"" + times(160000, "\\u0041", "") + "\"", "\"" + std::string(1000000, 'x') + "\"",
        "0." + std::string(1000000, '3'), "1e" + std::string(1000000, '0')}) {
    EXPECT_NE(status_of(text), 0U);
  }
  std::string keys;
  for (int i = 0; i < 70000; ++i) keys += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":0";
  EXPECT_EQ(status_of("{" + keys + "}"), 200U);
}

http::Request posted(std::string body, const std::string& type) {
  http::Request request;
  request.method = "POST";
  request.body = std::move(body);
  request.headers = {{"content-type", type}};
  return request;
}

TEST(Question, RefusesShortlyWhatIsLong) {
  std::string coords;
  std::optional<double> error;
  const ask::Parameters rows = {{.name = "coords", .into = &coords},
                                {.name = "error", .into = &error}};
  for (const auto& request :
       {posted("{\"" + std::string(900000, 'k') + "\":0}", "application/json"),
        posted("{\"" + times(300000, "\xc3\xa9", "") + "\":0}", "application/json"),
        posted(times(300000, "a", "&"), "application/x-www-form-urlencoded"),
        posted(times(300000, "a=1", "&"), "application/x-www-form-urlencoded")}) {
    try {
      const Question question(request, rows);
      ADD_FAILURE();
    } catch (const http::Problem& problem) {
      EXPECT_EQ(problem.status(), 400U);
      EXPECT_LT(problem.response().body.size(), 1000U);
    }
  }
  try {
    const Question question(
        posted("error=" + std::string(900000, 'x'), "application/x-www-form-urlencoded"), rows);
    question.read(rows);
    ADD_FAILURE();
  } catch (const http::Problem& problem) {
    EXPECT_LT(problem.detail().size(), 300U);
  }
  const Question question(
      posted(std::string(900000, '&') + "coords=here", "application/x-www-form-urlencoded"), rows);
  EXPECT_EQ(question.text("coords"), "here");
}

TEST(Question, KeepsTheMembersOfABodyAsTheyCame) {
  std::string pairs;
  std::optional<double> error;
  const ask::Parameters rows = {{.name = "pairs", .into = &pairs, .is_json = true},
                                {.name = "error", .into = &error}};
  const Question question(posted(R"({"pairs": [[1, 2.5], []], "error": 5})", "application/json"),
                          rows);
  EXPECT_EQ(question.text("pairs"), "[[1,2.5],[]]");
  EXPECT_EQ(question.json("pairs"), nlohmann::json::parse("[[1,2.5],[]]"));
  question.read(rows);
  EXPECT_EQ(error, 5.0);
  EXPECT_EQ(question.canonical(), "5:error1=55:pairs12=[[1,2.5],[]]");
}

}  // namespace
}  // namespace ptin::serve
