// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorting of more numbers than fit, in several levels of runs, and the memory that it takes.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "tests/storage/sorted_numbers.h"

namespace ptin::test {
namespace {

TEST(ExternalSorter, MergesNoMoreRunsThanItsMemoryHolds) {
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

TEST(ExternalSorter, HoldsNoMoreThanItsMemory) {
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
}

}  // namespace
}  // namespace ptin::test
