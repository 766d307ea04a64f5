// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/refusal.h"

#include <gtest/gtest.h>

namespace ptin::tools::testing {

void expect_refusal(const Outcome& outcome, int status, const std::string& words) {
  EXPECT_EQ(outcome.status, status) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(lines_in(outcome.err), 1U) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("ptin: ")) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

std::string small_store(const TestFolder& folder) {
  make_raster(folder.file("hills.tif"), {});
  EXPECT_EQ(
      run_ptin({"build", folder.file("hills.tif"), "-o", folder.file("hills.ptin"), "-q"}).status,
      0);
  return folder.file("hills.ptin");
}

}  // namespace ptin::tools::testing
