// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program that was built, in a process of its own, is the one that the other tests run within
// theirs.
#include <algorithm>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::run_ptin;
using testing::spawn_ptin;

/// CLI11 lists the options that an option excludes in the order of their addresses.
std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words(std::istream_iterator<std::string>(in), {});
  std::sort(words.begin(), words.end());
  return words;
}

class EverySubcommand : public ::testing::TestWithParam<const char*> {};

TEST_P(EverySubcommand, SaysInAProcessOfItsOwnWhatItSaysHere) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{GetParam(), "--help"},
        std::vector<std::string>{GetParam(), "/nonexistent", "--json"}}) {
    const auto spawned = spawn_ptin(arguments);
    const auto here = run_ptin(arguments);
    EXPECT_EQ(spawned.status, here.status);
    EXPECT_EQ(words_of(spawned.out), words_of(here.out));
    EXPECT_EQ(spawned.err, here.err);
    EXPECT_FALSE((spawned.out + spawned.err).empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Program, EverySubcommand,
                         ::testing::Values("build", "info", "refine", "export", "isoline", "locate",
                                           "profile", "highest", "volume", "sight", "viewshed",
                                           "stream", "unstream", "viewer", "tiles", "render",
                                           "verify", "completion"));

}  // namespace
}  // namespace ptin::tools
