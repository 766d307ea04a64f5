// SPDX-License-Identifier: GPL-3.0-or-later
//
// Words of the command line to people who wrote it wrongly, and its help.
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tests/tools/refusal.h"
#include "tools/facts/nearest_name.h"
#include "tools/ptin/command.h"

namespace ptin::tools {
namespace {

using testing::expect_refusal;
using testing::Outcome;
using testing::run_ptin;

TEST(Help, HasNoLineLongerThanATerminal) {
  std::vector<std::vector<std::string>> all = {{"--help"}};
  for (const Command& command : commands()) all.push_back({command.name, "--help"});
  for (const auto& words : all) {
    std::istringstream lines(run_ptin(words).out);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count)
      EXPECT_LE(line.size(), 100U) << words[0] << ": " << line;
    EXPECT_GT(count, 10) << words[0];
  }
}

TEST(Help, HasItsOptionsInOneIndentedList) {
  for (const Command& command : commands()) {
    const std::string help = run_ptin({command.name, "--help"}).out;
    std::istringstream list(help.substr(help.find("Options:\n")));
    std::string line;
    std::getline(list, line);
    bool has_last = false;
    while (std::getline(list, line) && !line.empty()) {
      EXPECT_TRUE(line.starts_with("  ")) << command.name << ": " << line;
      has_last = has_last || line.find("--quiet") != std::string::npos;
    }
    EXPECT_TRUE(has_last) << command.name;
  }
}

TEST(Help, IsTheSameByItsOtherNames) {
  const Outcome help = run_ptin({"help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.out, run_ptin({"--help"}).out);
  EXPECT_EQ(run_ptin({"help", "build"}).out, run_ptin({"build", "--help"}).out);
  EXPECT_EQ(run_ptin({"help", "build"}).status, 0);
  expect_refusal(run_ptin({"help", "frobnicate"}), 2, "no subcommand frobnicate; see");
}

TEST(Help, IsWhatNothingIsAnsweredBy) {
  const Outcome outcome = run_ptin({});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, run_ptin({"--help"}).out);
}

TEST(Usage, NamesWhatWasProbablyMeant) {
  expect_refusal(run_ptin({"isolines", "a.ptin"}), 2,
                 "there is no subcommand isolines; did you mean isoline?; see ptin --help");
  expect_refusal(run_ptin({"contour", "a.ptin"}), 2, "did you mean isoline?");
  expect_refusal(run_ptin({"biuld", "a.tif"}), 2, "did you mean build?");
  expect_refusal(run_ptin({"frobnicate"}), 2, "no subcommand frobnicate; see ptin --help");
  expect_refusal(run_ptin({"refine", "a.ptin", "--eror", "5", "-o", "a.ply"}), 2,
                 "there is no option --eror; did you mean --error?; see ptin refine --help");
  expect_refusal(run_ptin({"build", "a.tif", "-o", "a.ptin", "--mem=1G"}), 2,
                 "did you mean --memory?");
  expect_refusal(run_ptin({"locate", "a.ptin", "1", "2", "--by", "star"}), 2,
                 "--by: star is none of heights, stars, splits; did you mean stars?");
}

TEST(Usage, SaysHowManyValuesThereAreAndWhich) {
  expect_refusal(run_ptin({"locate", "a.ptin", "387500,3792500"}), 2,
                 "X Y are 2 values with a space between, and 1 was given: 387500,3792500; write "
                 "387500 3792500; see");
  expect_refusal(run_ptin({"locate", "a.ptin", "387500"}), 2, "1 was given: 387500; see");
  expect_refusal(run_ptin({"sight", "a.ptin", "1", "2", "3", "4", "5"}), 2,
                 "X1 Y1 H1 X2 Y2 H2 are 6 values with spaces between, and 5 were given: 1 2 3 4 5");
  expect_refusal(run_ptin({"refine", "a.ptin", "-o", "a.ply", "--window", "1", "2", "3"}), 2,
                 "--window takes 4 values with spaces between, XMIN YMIN XMAX YMAX");
  expect_refusal(run_ptin({"highest", "a.ptin", "--error", "1", "--error", "2"}), 2,
                 "--error takes one value, E, and 2 were given: 1 2");
  expect_refusal(run_ptin({"info", "a.ptin", "b.ptin", "c.ptin"}), 2,
                 "b.ptin c.ptin are words too many: ptin info takes FILE and options");
  expect_refusal(run_ptin({"info", "my", "terrain.ptin"}), 2,
                 "terrain.ptin is a word too many: ptin info takes FILE and options");
  expect_refusal(run_ptin({"locate", "a.ptin", "1", "2", "3", "4"}), 2,
                 "X Y are 2 values with a space between, and 4 were given: 1 2 3 4");
  expect_refusal(run_ptin({"highest", "a.ptin", "--error", "five"}), 2,
                 "--error: must be a number >= 0, in the height's unit, or with a unit behind it");
  expect_refusal(run_ptin({"sight", "a.ptin", "1", "2", "3", "4", "5", "6", "--curvature", "5m"}),
                 2, "--curvature: must be a number from 0 to 1; 5m is none");
  expect_refusal(run_ptin({"refine", "a.ptin", "--vertices", "1.5", "-o", "a.ply"}), 2,
                 "--vertices: must be a whole number >= 0; 1.5 is none");
}

TEST(NearestName, IsWithinAThirdOfTheWord) {
  const std::vector<std::string> names = {"build", "build-part", "info", "isoline"};
  EXPECT_EQ(nearest_name("bild", names), "build");
  EXPECT_EQ(nearest_name("isloine", names), "isoline");
  EXPECT_EQ(nearest_name("inf", names), "info");
  EXPECT_EQ(nearest_name("build-", names), "build");
  EXPECT_EQ(nearest_name("nonsense", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
}

}  // namespace
}  // namespace ptin::tools
