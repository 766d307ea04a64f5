// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/log_writer.h"

#include <array>
#include <chrono>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace ptin::serve {
namespace {

std::string all_of(int fd) {
  std::string text;
  std::array<char, 4096> bytes{};
  for (ssize_t n = 0; (n = ::read(fd, bytes.data(), bytes.size())) > 0;) {
    text.append(bytes.data(), static_cast<std::size_t>(n));
  }
  return text;
}

TEST(LogWriter, WritesEveryLineBeforeItEnds) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  {
    LogWriter log(ends[1]);
    for (int i = 0; i < 100; ++i) log.add("line " + std::to_string(i));
  }
  ::close(ends[1]);
  const std::string text = all_of(ends[0]);
  EXPECT_TRUE(text.starts_with("line 0\nline 1\n"));
  EXPECT_TRUE(text.ends_with("line 99\n"));
  ::close(ends[0]);
}

TEST(LogWriter, NeitherBlocksNorGrowsWhereNobodyReads) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const std::string line(10000, 'x');
  const auto begun = std::chrono::steady_clock::now();
  {
    LogWriter log(ends[1], 8);
    for (int i = 0; i < 1000; ++i) log.add(line);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(30));  // not for ever
  ::close(ends[1]);
  EXPECT_LT(all_of(ends[0]).size(), 100 * line.size());
  ::close(ends[0]);
}

}  // namespace
}  // namespace ptin::serve
