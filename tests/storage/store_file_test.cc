// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_file.h"

#include <gtest/gtest.h>

#include "storage/store_writer.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

TEST(StoreFile, GivesBackWhatWasWritten) {
  const TestFolder folder;
  for (const HeightType type : {HeightType::float32, HeightType::int32}) {
    for (const std::size_t records : {0U, 1U, 2U, 63U, 64U, 65U, 1000U, 30000U}) {
      RandomRecords options;
      options.records = records;
      options.segments = 2;
      options.type = type;
      const StoreContent content = random_content(options);
      const std::string path = folder.file("a.ptin");
      write_store(path, content, {.overwrite = true});
      const StarredRecords expected =
          sorted_by_key(as_kept(content.all_records(), content.facts.heights.type));
      for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
        const auto store = StoreFile::open(path, access);
        EXPECT_EQ(store->facts(), content.facts);
        EXPECT_EQ(store->metadata_json(), content.metadata);
        EXPECT_EQ(store->record_count(), 2 * records);
        const StarredRecords found = read_all_starred(*store);
        EXPECT_TRUE(are_same(sorted_by_key(found), expected)) << records;
        EXPECT_EQ(read_all(*store), found.splits);
      }
    }
  }
}

}  // namespace
}  // namespace ptin::test
