// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of a service's memory that is kept between questions.
#include <cstdint>

#include <gtest/gtest.h>

#include "tools/serve/serve_options.h"

namespace ptin::tools::testing {
namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

TEST(DividedMemory, HasAPartThatIsKept) {
  const auto kept_of = [](std::uint64_t memory, std::uint64_t question) {
    serve::ServeOptions options;
    options.http.memory_bytes = memory * kMebibyte;
    options.question.question_memory = question * kMebibyte;
    serve::divide_memory(options);
    EXPECT_LE(options.http.kept_bytes + options.http.question_bytes, options.http.memory_bytes);
    EXPECT_TRUE(memory == 0 || options.http.memory_bytes == memory * kMebibyte);
    return options.http.kept_bytes;
  };
  EXPECT_EQ(kept_of(64, 64), 0U);  // One question takes all.
  EXPECT_EQ(kept_of(80, 64), 0U);  // Beside it a point is answered.
  EXPECT_EQ(kept_of(100, 64), 0U);
  EXPECT_EQ(kept_of(112, 64), 8 * kMebibyte);
  EXPECT_EQ(kept_of(336, 64), 64 * kMebibyte);
  EXPECT_EQ(kept_of(10000, 64), 64 * kMebibyte);
  EXPECT_EQ(kept_of(0, 32), 32 * kMebibyte);
}

/// Where nobody says how much memory there is, what is kept takes nothing of what is lent.
TEST(DividedMemory, GrowsByWhatIsKept) {
  serve::ServeOptions options;
  options.http.threads = 2;
  options.http.memory_bytes = 0;
  serve::divide_memory(options);
  EXPECT_EQ(options.http.memory_bytes,
            (3 * 64 + 2 * 16) * kMebibyte * 6 / 5 + (16 + 64) * kMebibyte);
}

}  // namespace
}  // namespace ptin::tools::testing
