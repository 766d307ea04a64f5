// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/remote/remote_file.h"
#include "tests/support/range_server.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::RangeServer;
using test::TestFolder;

/// The rounds of several threads run together; one that fails takes nothing from the others. The
/// server answers no range before sixteen are under way, however slow the threads are.
TEST(RemoteFileThreads, ReadAtOnceAtMostSixteenRanges) {
  if (!RangeServer::is_possible()) GTEST_SKIP() << RangeServer::kNeeded;
  const TestFolder folder(TestFolder::Size::kSmall);
  std::vector<char> content(500000);
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * i >> 7);
  std::ofstream(folder.file("a"), std::ios::binary)
      .write(content.data(), static_cast<std::streamsize>(content.size()));
  const RangeServer server(folder.path().string());
  const auto source = open_remote(server.url("gate-16/a"));
  server.take_counts();
  std::atomic<int> wrong = 0;
  std::atomic<int> refused = 0;
  std::vector<std::thread> threads;
  for (std::uint64_t i = 0; i < 5; ++i) {
    threads.emplace_back([&, i] {
      for (std::uint64_t k = 0; k < 4; ++k) {
        std::vector<std::vector<std::byte>> out(7, std::vector<std::byte>(1000 + k));
        std::vector<RangeRead> ranges;
        // The last thread asks for bytes behind the end.
        const std::uint64_t begin = i == 4 ? 600000 : i * 90000;
        for (std::uint64_t r = 0; r < out.size(); ++r) {
          ranges.push_back({begin + r * 10000, out[r]});
        }
        try {
          source->read(ranges);
        } catch (const Error&) {
          ++refused;
          continue;
        }
        for (const RangeRead& r : ranges) {
          if (std::memcmp(r.out.data(), content.data() + r.offset, r.out.size()) != 0) ++wrong;
        }
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(refused, 4);
  const auto counts = server.take_counts();
  EXPECT_EQ(counts.most, 16U);
}

}  // namespace
}  // namespace ptin
