// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers that an external sorter is given, and what it must make of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "storage/file/external_sorter.h"

namespace ptin::test {

using Sorter = ExternalSorter<std::uint64_t, std::less<>>;

inline ExternalMemory memory_of_records(std::size_t records) {
  return {FileLayer::system(), "/tmp", records * sizeof(std::uint64_t)};
}

inline std::vector<std::uint64_t> numbers(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint64_t> result(count);
  for (std::uint64_t& n : result) {
    n = random() % (count / 2 + 1);  // many of them twice
  }
  return result;
}

inline std::vector<std::uint64_t> taken(Sorter& sorter) {
  std::vector<std::uint64_t> all;
  sorter.merge([&](std::span<const std::uint64_t> batch) {
    all.insert(all.end(), batch.begin(), batch.end());
  });
  return all;
}

/// Sorts, and expects what std::sort gives.
inline SortCounts expect_sorted(std::vector<std::uint64_t> records, std::size_t memory) {
  Sorter sorter(memory_of_records(memory));
  for (const std::uint64_t n : records) {
    sorter.add(n);
  }
  EXPECT_EQ(sorter.size(), records.size());
  std::sort(records.begin(), records.end());
  EXPECT_TRUE(taken(sorter) == records);
  return sorter.counts();
}

/// The least memory there is: 4096 records of a run, 16 runs at a time.
inline constexpr std::size_t kLeast = Sorter::kLeastRecords;
inline constexpr std::size_t kRun = kLeast - Sorter::kBatch;
inline constexpr std::size_t kWidest = kRun / Sorter::kLeastOfRun;

}  // namespace ptin::test
