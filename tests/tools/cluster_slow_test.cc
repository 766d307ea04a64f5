// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds by 2, 4 and 7 ranks, and ranks that are killed at random moments (five in all; twenty where all cases
// are asked for): the build goes on with another number of them.
#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/mpi_run.h"

namespace ptin::tools {
namespace {

class RanksSlow : public ::testing::TestWithParam<std::string> {};

TEST_P(RanksSlow, KilledAtRandomMomentsLoseNothing) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_kills_lose_nothing(GetParam(),
                                     (GetParam() == "tin" ? 4 : 8) / test::share_of_cases(4));
}

TEST_P(RanksSlow, GiveTheBytesOfOneProcess) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_same_bytes_on_ranks(GetParam(), {2, 4, 7});
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, RanksSlow, ::testing::Values("raster", "points", "tin"),
                         [](const auto& kind) { return kind.param; });

}  // namespace
}  // namespace ptin::tools
