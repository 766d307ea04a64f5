// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "storage/file/ranged_file.h"
#include "tests/storage/noting_source.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::noise;
using test::NotingSource;
using test::TestFolder;

constexpr std::uint64_t kBlock = RangedFile::kBlockBytes;

template <class Work>
void on_threads(int count, const Work& work) {
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back(work, i);
  for (std::thread& t : threads) t.join();
}

TEST(RangedFileThreads, ReadABlockOnce) {
  const auto source = std::make_shared<NotingSource>(noise(100 * kBlock));
  source->delay = std::chrono::milliseconds(20);
  const RangedFile file(source, {});
  on_threads(8, [&](int) {
    std::vector<std::byte> got(2 * kBlock);
    file.read_at(got, 40 * kBlock);
  });
  EXPECT_EQ(source->rounds.size(), 1U);
}

TEST(RangedFileThreads, AnnounceAndReadThroughOneSmallCache) {
  const std::vector<std::byte> content = noise(600 * kBlock + 5);
  const TestFolder folder(TestFolder::Size::kSmall);
  for (const bool on_disk : {false, true}) {
    const auto source = std::make_shared<NotingSource>(content, 3 * kBlock);
    RangedFile file(source, {0, on_disk ? folder.path().string() : std::string()});
    file.keep_on_disk(1);
    std::atomic<int> wrong = 0;
    on_threads(4, [&](int thread) {
      std::mt19937_64 random(static_cast<std::uint64_t>(thread));
      const auto below = [&](std::uint64_t n) { return random() % n; };
      IoCounters counters;
      for (int i = 0; i < 40; ++i) {
        std::vector<ByteRange> ranges;
        for (int k = 0; k < 5; ++k) ranges.push_back({below(content.size()), below(9 * kBlock)});
        file.will_need(ranges);
        const std::uint64_t offset = below(content.size());
        std::vector<std::byte> got(
            std::min<std::uint64_t>(content.size() - offset, 1 + below(20 * kBlock)));
        file.read_at(got, offset);
        if (!std::equal(got.begin(), got.end(), content.begin() + static_cast<long>(offset))) {
          ++wrong;
        }
        static_cast<void>(file.is_at_hand({offset, 1}));
        file.settle(counters);
        file.check_unchanged();
      }
    });
    EXPECT_EQ(wrong, 0);
  }
}

}  // namespace
}  // namespace ptin
