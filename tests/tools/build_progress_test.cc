// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `ptin build --progress-fd` tells the program that runs it.
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

TEST(BuildProgress, TellsStagesTilesSpeedTimeAndMemory) {
  const testing::TestFolder folder;
  const auto outcome =
      testing::run_ptin({"build", testing::test_data("mountains_257.tif"), "-o",
                         folder.file("m.ptin"), "--tile", "64", "-q", "--progress-fd", "2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::istringstream lines(outcome.err);
  std::set<std::string> stages;
  nlohmann::json last_of_collapsing;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json j = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(j.is_object()) << line;
    for (const char* key : {"done", "total", "seconds", "memory", "tiles_done", "tiles",
                            "per_second", "remaining_seconds"}) {
      EXPECT_TRUE(j.contains(key)) << key;
    }
    stages.insert(j.at("stage").get<std::string>());
    if (j.at("stage") == "collapsing") last_of_collapsing = j;
  }
  EXPECT_EQ(stages, (std::set<std::string>{"reading", "collapsing", "tightening", "writing"}));
  EXPECT_EQ(last_of_collapsing.at("tiles"), 16);
  EXPECT_EQ(last_of_collapsing.at("tiles_done"), 16);
  EXPECT_GT(last_of_collapsing.at("per_second"), 0);
  EXPECT_GT(last_of_collapsing.at("memory"), 0);
}

}  // namespace
}  // namespace ptin::tools
