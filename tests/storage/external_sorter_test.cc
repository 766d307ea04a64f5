// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/external_sorter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <rapidcheck/gtest.h>

#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using Sorter = ExternalSorter<std::uint64_t, std::less<>>;

ExternalMemory memory_of_records(std::size_t records) {
  return {FileLayer::system(), "/tmp", records * sizeof(std::uint64_t)};
}

std::vector<std::uint64_t> numbers(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint64_t> result(count);
  for (std::uint64_t& n : result) {
    n = random() % (count / 2 + 1);  // many of them twice
  }
  return result;
}

std::vector<std::uint64_t> taken(Sorter& sorter) {
  std::vector<std::uint64_t> all;
  sorter.merge([&](std::span<const std::uint64_t> batch) {
    all.insert(all.end(), batch.begin(), batch.end());
  });
  return all;
}

/// Sorts, and expects what std::sort gives.
SortCounts expect_sorted(std::vector<std::uint64_t> records, std::size_t memory) {
  Sorter sorter(memory_of_records(memory));
  for (const std::uint64_t n : records) {
    sorter.add(n);
  }
  EXPECT_EQ(sorter.size(), records.size());
  std::sort(records.begin(), records.end());
  EXPECT_TRUE(taken(sorter) == records);
  return sorter.counts();
}

TEST(ExternalSorter, KeepsInMemoryWhatFits) {
  for (const std::size_t count : {0, 1, 4096, 5000, 40'000}) {
    const SortCounts counts = expect_sorted(numbers(count, 1), 1 << 17);
    EXPECT_EQ(counts.runs, 0U);
    EXPECT_EQ(counts.written, 0U);
  }
}

/// The least memory there is: 4096 records of a run, 16 runs at a time.
constexpr std::size_t kLeast = Sorter::kLeastRecords;
constexpr std::size_t kRun = kLeast - Sorter::kBatch;
constexpr std::size_t kWidest = kRun / Sorter::kLeastOfRun;

TEST_IN_RELEASE(ExternalSorter, MergesNoMoreRunsThanItsMemoryHolds) {
  const std::size_t count = 1'500'000;  // runs of three levels
  const SortCounts counts = expect_sorted(numbers(count, 2), 1);
  EXPECT_GE(counts.runs, count / kRun);
  EXPECT_LE(counts.runs, count / (kRun / 2));
  EXPECT_GT(counts.runs, kWidest * kWidest);
  EXPECT_GT(counts.merges, kWidest);
  EXPECT_LE(counts.widest, kWidest);
  EXPECT_LE(counts.held, kLeast);
  EXPECT_LE(counts.written, 3 * count);
  EXPECT_GT(counts.written, 2 * count);
}

TEST(ExternalSorter, MergesOnlyAsManyAsItMust) {
  const auto counts_of = [](std::size_t runs) { return expect_sorted(numbers(runs * kRun, 3), 1); };
  const SortCounts fits = counts_of(kWidest - 1);
  EXPECT_EQ(fits.merges, 0U);
  EXPECT_EQ(fits.written, (kWidest - 1) * kRun);
  const SortCounts more = counts_of(2 * kWidest - 2);
  EXPECT_LE(more.widest, kWidest);
  EXPECT_GE(more.merges, 1U);
  EXPECT_LE(more.written, (3 * kWidest) * kRun);
}

TEST(ExternalSorter, HoldsNoMoreThanItsMemory) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const auto in_use = [] {
    const struct mallinfo2 m = mallinfo2();
    return m.uordblks + m.hblkhd;
  };
  const std::size_t memory = 64 * 1024;
  const std::vector<std::uint64_t> records = numbers(1'500'000, 4);
  const std::size_t before = in_use();
  std::size_t most = 0;
  Sorter sorter(memory_of_records(memory));
  for (std::size_t i = 0; i < records.size(); ++i) {
    sorter.add(records[i]);
    if (i % 1000 == 0) {
      most = std::max(most, in_use() - before);
    }
  }
  sorter.merge([&](std::span<const std::uint64_t>) { most = std::max(most, in_use() - before); });
  EXPECT_GT(most, memory * sizeof(std::uint64_t) / 2);
  // Beside the records: a hundred bytes for each run that is merged.
  EXPECT_LE(most, memory * sizeof(std::uint64_t) + (memory / Sorter::kLeastOfRun + 20) * 200);
#endif
}

TEST(ExternalSorter, StopsWhileItMerges) {
  std::stop_source stop;
  Sorter sorter(memory_of_records(1), "sorted", stop.get_token());
  const auto add = [&] {
    for (std::size_t i = 0; i < 2 * kWidest * kRun; ++i) {
      sorter.add(i);
    }
  };
  stop.request_stop();
  try {
    add();
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

RC_GTEST_PROP(ExternalSorter, GivesBackWhatItGotInOrder, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(0, 250'000);
  const auto memory = *rc::gen::inRange<std::size_t>(1, 20'000);
  std::vector<std::uint64_t> records = numbers(count, *rc::gen::arbitrary<std::uint64_t>());
  if (*rc::gen::arbitrary<bool>()) {
    std::sort(records.begin(), records.end(), std::greater<>());
  }
  const SortCounts counts = expect_sorted(records, memory);
  RC_ASSERT(counts.held <= std::max(memory, kLeast));
  RC_ASSERT(counts.widest <= std::max(memory, kLeast) / Sorter::kLeastOfRun);
}

}  // namespace
}  // namespace ptin
