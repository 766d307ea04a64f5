// SPDX-License-Identifier: GPL-3.0-or-later
//
// The guard: no count of tests/guard/counts.csv becomes worse by the way. CONTRIBUTING.md, "Counts",
// says what to do when one has to.
#include "tests/guard/counts.h"

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"

namespace ptin::guard {
namespace {

constexpr const char* kTable = PTIN_TEST_DATA "/../guard/counts.csv";
constexpr double kTolerance = 0.01;

Counts all_counts() {
  Counts all;
  for (const char* terrain : {"mountains_257.tif", "coast_257.tif", "ground_points.csv"}) {
    const Counts counts = counts_of(terrain);
    all.insert(all.end(), counts.begin(), counts.end());
  }
  return all;
}

TEST(Guard, NoCountIsWorseThanInTheTable) {
  for (const std::string& fault : what_is_worse(read_table(kTable), all_counts(), kTolerance)) {
    ADD_FAILURE() << fault;
  }
}

/// Run by hand, to write the table again:
/// test_guard --gtest_also_run_disabled_tests --gtest_filter='*WritesTheTable'
TEST(Guard, DISABLED_WritesTheTable) { write_table(kTable, all_counts()); }

TEST(Guard, FindsWhatIsWorse) {
  const Counts table = {{"a.tif", "pages", 100}, {"a.tif", "point, exact: nodes", 4}};
  const auto with = [&](double pages) {
    Counts now = table;
    now[0].value = pages;
    return what_is_worse(table, now, kTolerance);
  };
  EXPECT_EQ(with(101).size(), 0U);
  EXPECT_EQ(with(50).size(), 0U) << "better is no fault";
  ASSERT_EQ(with(101.1).size(), 1U);
  EXPECT_EQ(with(101.1)[0], "a.tif, pages is 101.1000, and was 100.0000");
  EXPECT_EQ(what_is_worse(table, {table[0]}, kTolerance).size(), 1U) << "a row is not counted";
  EXPECT_EQ(what_is_worse({table[0]}, table, kTolerance).size(), 1U) << "a count has no row";
}

TEST(Guard, ReadsTheTableThatItWrites) {
  const test::TestFolder folder;
  const Counts table = {{"a.tif", "pages", 100}, {"a.tif", "point, exact: nodes", 4.25}};
  write_table(folder.file("t.csv"), table);
  EXPECT_EQ(read_table(folder.file("t.csv")), table);
  EXPECT_THROW(static_cast<void>(read_table(folder.file("none.csv"))), std::runtime_error);
}

}  // namespace
}  // namespace ptin::guard
