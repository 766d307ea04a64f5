// SPDX-License-Identifier: GPL-3.0-or-later
//
// The command line has the options of the table.
#include "engine/construct/build_option_table.h"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

TEST(BuildOptionTable, IsWhatHelpHas) {
  const std::string help = testing::run_ptin({"build", "--help"}).out;
  EXPECT_NE(help.find("--cost TEXT:{error,roi,elevation}"), std::string::npos) << help;
  for (const BuildOption& option : build_option_table()) {
    EXPECT_NE(help.find(std::string("--") + option.name), std::string::npos) << option.name;
    EXPECT_NE(help.find(option.value == nullptr ? "" : option.value), std::string::npos);
    std::istringstream words(option.help);
    for (std::string word; words >> word;) {  // help breaks lines where it likes
      EXPECT_NE(help.find(word), std::string::npos) << option.name << ": " << word;
    }
  }
}

}  // namespace
}  // namespace ptin::tools
