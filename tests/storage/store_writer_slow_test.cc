// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file that has an index too long for memory, and faults while it is written.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "storage/verify.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/share_of_cases.h"
#include "tests/support/test_folder.h"

namespace ptin::test {
namespace {

TEST(StoreWriter, KeepsALongIndexInASideFile) {
  const TestFolder folder;
  RandomRecords options;
  options.segments = 4;
  options.records = 40000;  // 2000 pages: 36 leaves, and 16 are kept in memory
  const StoreContent content = random_content(options);
  write_store(folder.file("a.ptin"), content);
  EXPECT_TRUE(verify_store(folder.file("a.ptin")).is_sound());
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.ptin"});
}

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
