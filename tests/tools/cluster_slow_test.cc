// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ranks that are killed at twenty random moments: the build goes on with another number of them.
#include <gtest/gtest.h>

#include "tests/tools/mpi_run.h"

namespace ptin::tools {
namespace {

class RanksThatAreKilledSlow : public ::testing::TestWithParam<std::string> {};

TEST_P(RanksThatAreKilledSlow, AtTwentyMomentsLoseNothing) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_kills_lose_nothing(GetParam(), 10);
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, RanksThatAreKilledSlow, ::testing::Values("raster", "points"),
                         [](const auto& kind) { return kind.param; });

}  // namespace
}  // namespace ptin::tools
