// SPDX-License-Identifier: GPL-3.0-or-later
//
// The second index of a store whose pages are too many for the memory of its sorter.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "storage/spatialindex_rtree.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

TEST(SpatialIndexRTree, SortsWithLittleMemoryInTheGivenFolderAndLeavesNothingThere) {
  const TestFolder folder, scratch;
  const std::string path = folder.file("a.ptin");
  RandomRecords options;
  options.segments = 70;
  options.records = 6400;
  options.side = 30000;
  write_store(path, random_content(options));
  const auto store = StoreFile::open(path);
  ASSERT_GT(store->pages().page_count(), 64U * 64U) << "so many that the sorter has to spill";
  const auto before = std::filesystem::current_path();
  const auto index = SpatialIndexRTree::open(
      store, {.base = folder.file("b"), .temporary_folder = scratch.path(), .memory_bytes = 1});
  EXPECT_EQ(std::filesystem::current_path(), before);
  EXPECT_TRUE(scratch.names().empty());
  const FunctionPredicate predicate([](const Attributes& a) {
    return a.error > 20.0 && meets(a.roi, {100, 100, 5000, 5000});
  });
  const auto found = [&](const RecordIndex& any) {
    std::vector<PageId> pages;
    IoCounters counters;
    any.search(predicate, pages, counters);
    return pages;
  };
  EXPECT_EQ(found(*index), found(store->index()));
}

}  // namespace
}  // namespace ptin::test
