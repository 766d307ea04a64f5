// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cost of CRSs that are new to the service.
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "tools/serve/transformations.h"

namespace ptin::serve {
namespace {

using std::chrono::seconds;

TEST(MakingTime, IsLentUntilItIsSpentAndComesBackByItsShare) {
  MakingTime time(MakingTime::Seconds(2), 0.25);
  const MakingTime::Clock::time_point begun(seconds(1000));
  EXPECT_EQ(time.take(begun).count(), 0);
  time.settle(MakingTime::Seconds(1.5));
  EXPECT_EQ(time.take(begun).count(), 0);  // Half a second is left.
  time.settle(MakingTime::Seconds(1.5));
  EXPECT_EQ(time.take(begun).count(),
            4);  // A second is owed, of which a quarter comes each second.
  EXPECT_EQ(time.take(begun + seconds(2)).count(), 2);
  EXPECT_EQ(time.take(begun + seconds(5)).count(), 0);
}

TEST(MakingTime, BoundsHowManyAreMadeAtOnce) {
  MakingTime time(MakingTime::Seconds(2), 0.25);
  const MakingTime::Clock::time_point begun(seconds(1000));
  int begins = 0;
  while (time.take(begun).count() == 0) ++begins;
  EXPECT_EQ(begins, 8);  // A quarter of a second is taken ahead for each of them.
}

TEST(MakingTime, ComesBackNoFurtherThanItWas) {
  MakingTime time(MakingTime::Seconds(1), 0.5);
  const MakingTime::Clock::time_point begun(seconds(1000));
  EXPECT_EQ(time.take(begun).count(), 0);
  EXPECT_EQ(time.take(begun + seconds(1000)).count(), 0);
  time.settle(MakingTime::Seconds(2));
  EXPECT_GT(time.take(begun + seconds(1000)).count(), 0);
}

TEST(MakingTime, KeepsSomeForWhoSpentLess) {
  MakingTime time(MakingTime::Seconds(8), 0.25);
  const MakingTime::Clock::time_point begun(seconds(1000));
  const auto begins_of = [&](const std::string& who) {
    int begins = 0;
    while (time.take(begun, who).count() == 0) ++begins;
    return begins;
  };
  EXPECT_EQ(begins_of("a"), 17);  // A quarter of a second each: until it has more than is left.
  EXPECT_EQ(begins_of("b"), 8);
  EXPECT_EQ(time.take(begun, "c").count(), 0);
  EXPECT_GT(time.take(begun, "a").count(), 0);
  EXPECT_EQ(time.take(begun + seconds(20), "a").count(), 0);  // Most of it has come back.
}

}  // namespace
}  // namespace ptin::serve
