// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/stored_detail.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "storage/short_float.h"

namespace ptin {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// A record with an error, whose ring has corners of these deaths.
void add(StarredRecords& records, float error, const std::vector<float>& deaths) {
  VertexSplit r;
  r.error = error;
  r.deviation = 2.0F * error;
  records.splits.push_back(r);
  for (const float death : deaths) {
    RingCorner corner;
    corner.position.x = static_cast<int>(records.corners.size());
    corner.death = death;
    records.corners.push_back(corner);
  }
  records.ring_end.push_back(static_cast<std::uint32_t>(records.corners.size()));
}

std::vector<float> deaths_in(std::span<const RingCorner> ring) {
  std::vector<float> deaths;
  for (const RingCorner& c : ring) {
    deaths.push_back(c.death);
  }
  return deaths;
}

TEST(StoredDetail, ShortensErrorsAndDeathsAlikeWhereNothingIsLeftOut) {
  const StoredDetail detail;
  for (const float error : {0.0F, 0.1F, 7.0F, kInfinite}) {
    EXPECT_EQ(detail.rounded(error), shortened(error));
    EXPECT_EQ(detail.death(error), shortened(error));
    EXPECT_FALSE(detail.leaves_out(error));
  }
  EXPECT_EQ(detail.death(kLivesOn), kLivesOn);
}

TEST(StoredDetail, RoundsADeathAsTheErrorThatItIs) {
  const StoredDetail detail{0.001, 0.0};
  for (const float error : {0.0F, 0.1F, 7.0F, 1e9F, kInfinite}) {
    EXPECT_EQ(detail.death(error), detail.rounded(error));
    EXPECT_GE(static_cast<double>(detail.death(error)), static_cast<double>(error) + 0.001);
  }
  EXPECT_EQ(detail.death(kLivesOn), kLivesOn);
}

TEST(StoredDetail, ATriangleLivesOnExactlyWhenItsSuccessorIsLeftOut) {
  const StoredDetail detail{0.5, 2.0};
  for (const float error : {0.0F, 1.0F, 1.5F, 1.5000001F, 2.0F, kInfinite}) {
    EXPECT_EQ(detail.death(error) == kLivesOn, detail.leaves_out(detail.rounded(error))) << error;
  }
  EXPECT_EQ(detail.death(1.5F), kLivesOn) << "just at the largest error";
  EXPECT_GT(detail.death(1.5000001F), 2.0F);
}

TEST(StoredDetail, LeavesRecordsOutWithTheirStars) {
  StarredRecords records;
  add(records, 1.0F, {0.5F, kLivesOn});
  add(records, 4.0F, {3.0F, 1.0F, kLivesOn});
  add(records, 2.0F, {});
  add(records, 3.0F, {2.5F, 2.0F, 2.0F, kLivesOn});
  add(records, 0.0F, {kLivesOn});
  const StoredDetail detail{0.0, 2.0};
  detail.add_rounding(records);
  const RecordBounds worst = detail.leave_out(records);
  EXPECT_EQ(worst, (RecordBounds{2.0F, 4.0F}));
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records.splits[0].error, 4.0F);
  EXPECT_EQ(deaths_in(records.ring(0)), (std::vector<float>{3.0F, kLivesOn, kLivesOn}));
  EXPECT_EQ(records.ring(0)[0].position.x, 2);
  EXPECT_EQ(records.splits[1].error, 3.0F);
  EXPECT_EQ(deaths_in(records.ring(1)), (std::vector<float>{2.5F, kLivesOn, kLivesOn, kLivesOn}));
  EXPECT_EQ(records.ring(1)[0].position.x, 5);
  EXPECT_EQ(records.corners.size(), 7U);
}

TEST(StoredDetail, LeavesNothingOutWithoutALargestError) {
  StarredRecords records;
  add(records, 0.0F, {kLivesOn, 0.0F});
  const StoredDetail detail{0.0, 0.0};
  detail.add_rounding(records);
  EXPECT_EQ(detail.leave_out(records), RecordBounds{});
  EXPECT_EQ(records.size(), 1U);
  EXPECT_EQ(deaths_in(records.ring(0)), (std::vector<float>{kLivesOn, 0.0F}));
}

}  // namespace
}  // namespace ptin
