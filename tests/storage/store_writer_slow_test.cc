// SPDX-License-Identifier: GPL-3.0-or-later
//
// Faults while a file is written that has an index too long for memory.
#include <gtest/gtest.h>

#include "tests/storage/failing_files.h"
#include "tests/support/share_of_cases.h"

namespace ptin::test {
namespace {

TEST(StoreWriterFaults, LeaveTheOldFileOrTheNewOneWithASideFileToo) {
  RandomRecords options;
  options.seed = 2;
  options.segments = 2;
  options.records = 52000;  // 1300 pages: 23 leaves, and 16 are kept in memory
  options.side = 30000;
  expect_old_or_new(random_content(options), share_of_cases(3));
}

}  // namespace
}  // namespace ptin::test
