// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/sample_lists.h"

#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

/// Lists beside plain vectors that say what is in them.
struct Checked {
  SampleLists lists;
  std::vector<SampleSlot> slots;
  std::vector<std::vector<std::int32_t>> known;

  void take(std::uint32_t count, std::int32_t value) {
    slots.push_back(lists.take(count));
    known.emplace_back();
    std::int32_t next = value;
    for (Sample& s : lists.samples(slots.back())) {
      s.position = {next, -next};
      known.back().push_back(next++);
    }
  }
  void give_back(std::size_t i) {
    lists.give_back(slots[i]);
    slots.erase(slots.begin() + static_cast<std::ptrdiff_t>(i));
    known.erase(known.begin() + static_cast<std::ptrdiff_t>(i));
  }
  void close_gaps() {
    std::vector<SampleSlot*> all;
    for (SampleSlot& slot : slots) {
      if (slot.count > 0) {
        all.push_back(&slot);
      }
    }
    lists.close_gaps(std::move(all));
  }
  [[nodiscard]] bool holds() {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      std::vector<std::int32_t> found;
      for (const Sample& s : lists.samples(slots[i])) {
        found.push_back(s.position.x);
      }
      if (found != known[i]) {
        return false;
      }
    }
    return true;
  }
};

TEST(SampleLists, KeepListsThroughGapsThatClose) {
  std::mt19937 random(5);
  Checked checked;
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 200; ++i) {
      checked.take(static_cast<std::uint32_t>(random() % 40),
                   static_cast<std::int32_t>(random() % 1'000'000));
    }
    for (int i = 0; i < 190; ++i) {
      checked.give_back(random() % checked.slots.size());
    }
    ASSERT_TRUE(checked.holds());
    checked.slots[random() % checked.slots.size()].count /= 2;  // as carried samples are
    for (std::size_t i = 0; i < checked.slots.size(); ++i) {
      checked.known[i].resize(checked.slots[i].count);
    }
    checked.close_gaps();
    ASSERT_TRUE(checked.holds());
    ASSERT_FALSE(checked.lists.is_sparse());
  }
}

TEST(SampleLists, LeaveNothingBetweenListsWhenGapsClose) {
  Checked checked;
  for (int i = 0; i < 3; ++i) {
    checked.take(5, 100 * i);
  }
  checked.give_back(1);
  checked.close_gaps();
  EXPECT_EQ(checked.lists.used(), 16U);
  EXPECT_EQ(checked.slots[1].offset, 8U);
  checked.take(8, 700);
  EXPECT_EQ(checked.slots[2].offset, 16U);
  EXPECT_TRUE(checked.holds());
}

TEST(SampleLists, MayBeEmptyWhenGapsClose) {
  Checked checked;
  checked.close_gaps();
  checked.take(3, 1);
  checked.give_back(0);
  checked.close_gaps();
  EXPECT_EQ(checked.lists.used(), 0U);
  checked.take(3, 2);
  EXPECT_TRUE(checked.holds());
}

}  // namespace
}  // namespace ptin
