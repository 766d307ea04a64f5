// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/front.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/front_answers.h"
#include "tools/output/standard_output.h"

namespace ptin::tools {
namespace {

using testing::front_answers;

TEST(FrontProgram, AnswersWhatNeedsNoLibraryOfFormats) {
  const std::vector<std::string> answered[] = {
      {"info", "a.ptin"},
      {"locate", "a.ptin", "1", "2", "--json"},
      {"locate", "a.ptin", "-1", "-2", "-o", "a.geojson"},
      {"sight", "a.ptin", "1", "2", "3", "4", "5", "6", "-o", "a.png"},
      {"isoline", "a.ptin", "--level", "1", "-o", "-"},
      {"isoline", "a.ptin", "--level", "1", "-o", "a.xml"},
      {"refine", "a.ptin", "-o", "a.ply"},
      {"export", "a.ptin", "-o", "a.dxf"},
  };
  for (const auto& words : answered)
    EXPECT_TRUE(front_answers(words)) << ::testing::PrintToString(words);
}

/// Standard input cannot be read a second time by the whole program.
TEST(FrontProgram, LeavesStandardInputAndWhatGdalReadsAndWritesToTheWholeProgram) {
  const std::vector<std::string> left[] = {
      {"build", "a.tif", "-o", "a.ptin"},
      {"info", "https://example.org/a.ptin"},
      {"info", "/vsizip/a.zip/a.ptin"},
      {"locate", "a.ptin", "--points", "-"},
      {"locate", "a.ptin", "--points", "a.csv"},
      {"viewer", "-o", "site", "--stream", "-"},
      {"highest", "a.ptin", "--polygon", "POLYGON((0 0, 1 0, 1 1, 0 0))"},
      {"isoline", "a.ptin", "--level", "1", "-o", "a.fgb"},
      {"isoline", "a.ptin", "--level", "1", "-o", "a.dxf"},
      {"export", "a.ptin", "-o", "a.TIF"},
      {"verify", "a.ptin"},
  };
  for (const auto& words : left)
    EXPECT_FALSE(front_answers(words)) << ::testing::PrintToString(words);
}

/// What left the buffer cannot be taken back, so the whole program would write it once more.
TEST(FrontProgram, KnowsWhetherSomeOfTheAnswerLeft) {
  const auto left_after = [](bool is_flushed) {
    write_to_stdout("a part of the answer");
    if (is_flushed) finish_stdout();
    std::_Exit(has_left_stdout() ? 1 : 0);
  };
  // A process of its own: what earlier tests wrote counts as left.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(left_after(false), ::testing::ExitedWithCode(0), "");
  EXPECT_EXIT(left_after(true), ::testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace ptin::tools
