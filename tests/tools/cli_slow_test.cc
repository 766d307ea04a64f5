// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds of the real terrains of the tree say nothing where they are to be quiet.
#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::Outcome;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

TEST(Cli, ABuildIsSilentWhereItIsToBeQuiet) {
  const TestFolder folder;
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    const Outcome outcome = run_ptin({"build", test_data(name), "-o", folder.file(name), "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out + outcome.err, "");
  }
}

}  // namespace
}  // namespace ptin::tools
