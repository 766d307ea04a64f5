// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/external_sorter.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/storage/sorted_numbers.h"

namespace ptin::test {
namespace {

TEST(ExternalSorter, KeepsInMemoryWhatFits) {
  for (const std::size_t count : {0, 1, 4096, 5000, 40'000}) {
    const SortCounts counts = expect_sorted(numbers(count, 1), 1 << 17);
    EXPECT_EQ(counts.runs, 0U);
    EXPECT_EQ(counts.written, 0U);
  }
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
}  // namespace ptin::test
