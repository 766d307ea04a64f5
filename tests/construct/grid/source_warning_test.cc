// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/source_warning.h"

#include <gtest/gtest.h>

#include "engine/construct/grid/warnings_file.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

SourceWarnings one(const char* file, const char* message, std::uint64_t count) {
  SourceWarnings w;
  w.add({"odd_height", message, file, "-9999", 7, count});
  return w;
}

TEST(SourceWarnings, OfOneKindAndSubjectAreOneWithTheFirstMessage) {
  SourceWarnings all = one("a.tif", "first", 3);
  all.join(one("a.tif", "second", 4));
  all.join(one("b.tif", "third", 5));
  ASSERT_EQ(all.all().size(), 1U);
  EXPECT_EQ(all.all()[0].message, "first");
  EXPECT_EQ(all.all()[0].count, 12U);
  EXPECT_EQ(all.all()[0].files, 2U);
  all.add({"odd_height", "of another value", "b.tif", "0"});
  EXPECT_EQ(all.all().size(), 2U);
}

TEST(SourceWarnings, AreTheSameHoweverTheSourceIsDivided) {
  SourceWarnings parts = one("a.tif", "first", 1), rest = one("a.tif", "second", 1);
  rest.join(one("b.tif", "third", 1));
  rest.join(one("c.tif", "fourth", 1));
  parts.join(rest);
  EXPECT_EQ(parts.all()[0].files, 3U);
  EXPECT_EQ(parts.all()[0].count, 4U);
  EXPECT_EQ(parts.all()[0].last_file, "c.tif");
}

TEST(SourceWarnings, AreTakenFromTheFileThatTheyWerePutInto) {
  const test::TestFolder folder;
  SourceWarnings all = one("a.tif", "first", 3);
  all.join(one("b.tif", "second", 1));
  all.add({"other", "of no file", ""});
  ArrayFileWriter writer(FileLayer::system(), folder.file("warnings"));
  writer.values(all);
  const ArrayFileFacts facts = writer.finish();
  ArrayFileReader reader(folder.file("warnings"), facts);
  SourceWarnings taken;
  reader.values(taken);
  EXPECT_TRUE(reader.at_end());
  ASSERT_EQ(taken.all().size(), 2U);
  const SourceWarning& w = taken.all()[0];
  EXPECT_EQ(w.kind + w.message + w.file + w.subject, "odd_heightfirsta.tif-9999");
  EXPECT_EQ(w.line, 7U);
  EXPECT_EQ(w.count, 4U);
  EXPECT_EQ(w.files, 2U);
  EXPECT_EQ(w.last_file, "b.tif");
  EXPECT_EQ(taken.all()[1].message, "of no file");
}

}  // namespace
}  // namespace ptin
