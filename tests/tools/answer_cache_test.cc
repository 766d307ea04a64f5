// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/answer_cache.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

namespace ptin::serve {
namespace {

http::Response answer(const std::string& body) {
  http::Response response;
  response.content_type = "text/plain";
  response.body = body;
  response.add("ETag", "\"" + body.substr(0, 3) + "\"");
  response.add("Server-Timing", "query;dur=5");
  return response;
}

TEST(AnswerCache, GivesTheSameBytesAndTellsThatTheyWereKept) {
  AnswerCache cache(1 << 20);
  EXPECT_FALSE(cache.find("a"));
  http::Response made = answer("abcdef");
  cache.keep("a", made);
  EXPECT_EQ(made.lasting_body, "abcdef");
  EXPECT_EQ(made.headers.size(), 2U);
  const auto found = cache.find("a");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lasting_body, "abcdef");
  EXPECT_EQ(found->content_type, "text/plain");
  EXPECT_EQ(found->headers[0].second, "\"abc\"");
  EXPECT_EQ(found->headers[1].second, "cache;desc=\"hit\"");
}

TEST(AnswerCache, CountsWhatIsStillBeingSentWhenItLeft) {
  constexpr std::size_t kBody = 3000;
  AnswerCache cache(20 * (kBody + 600));
  std::vector<http::Response> slow;  // Nobody takes them.
  int kept = 0;
  for (int i = 0; i < 100; ++i) {
    slow.push_back(answer(std::string(kBody, 'a')));
    cache.keep(std::to_string(i), slow.back());
    kept += slow.back().held ? 1 : 0;
  }
  EXPECT_GE(kept, 40);
  EXPECT_LE(kept, 50);
  slow.clear();
  http::Response next = answer(std::string(kBody, 'b'));
  cache.keep("next", next);
  EXPECT_TRUE(next.held);
}

TEST(AnswerCache, LetsGoOfWhatWasNotAskedForLongest) {
  constexpr std::size_t kBody = 3000;
  AnswerCache cache(20 * (kBody + 600));
  for (int i = 0; i < 20; ++i) {
    http::Response made = answer(std::string(kBody, static_cast<char>('a' + i)));
    cache.keep(std::to_string(i), made);
    EXPECT_TRUE(cache.find("0")) << i;  // It is asked for again and again.
  }
  http::Response large = answer(std::string(kBody, 'z'));
  cache.keep("large", large);
  http::Response larger = answer(std::string(kBody, 'y'));
  cache.keep("larger", larger);
  EXPECT_LE(cache.bytes(), 20 * (kBody + 600));
  EXPECT_TRUE(cache.find("0"));
  EXPECT_TRUE(cache.find("larger"));
  EXPECT_FALSE(cache.find("1"));
}

TEST(AnswerCache, KeepsNothingThatTakesAnUndueShare) {
  AnswerCache cache(16000);
  http::Response made = answer(std::string(2000, 'a'));
  cache.keep("a", made);
  EXPECT_EQ(made.body.size(), 2000U);
  EXPECT_FALSE(cache.find("a"));
  EXPECT_EQ(cache.bytes(), 0U);
}

/// A text that grew, or was packed, has room for more than it holds.
TEST(AnswerCache, KeepsNoRoomBesideTheBytes) {
  constexpr std::size_t kBody = 3000;
  AnswerCache cache(1 << 20);
  http::Response made = answer(std::string(kBody, 'a'));
  made.body.reserve(50 * kBody);
  cache.keep("a", made);
  ASSERT_EQ(made.lasting_body.size(), kBody);
  EXPECT_LE(::malloc_usable_size(const_cast<char*>(made.lasting_body.data())), kBody + 100);
}

TEST(AnswerCache, BytesOutliveTheCache) {
  http::Response response;
  {
    AnswerCache cache(1 << 20);
    http::Response made = answer("abcdef");
    cache.keep("a", made);
    response = std::move(*cache.find("a"));
  }
  EXPECT_EQ(response.lasting_body, "abcdef");
}

}  // namespace
}  // namespace ptin::serve
