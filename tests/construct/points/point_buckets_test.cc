// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_buckets.h"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/grid/point_order.h"
#include "engine/construct/grid/source_options.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "tests/construct/point_sets.h"
#include "tests/construct/point_source.h"
#include "tests/construct/read_buckets.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

/// Buckets hold what read_points() gives, which keeps everything in memory.
void expect_same(const std::string& path, const SourceOptions& options, std::uint64_t memory,
                 const SortSizes& sizes = {}) {
  const PointSet set = read_points({path}, options);
  const PointBuckets buckets = read_buckets({path}, options, memory, sizes);
  ASSERT_EQ(buckets.size(), set.positions.size());
  EXPECT_EQ(buckets.counts().merged_points, set.merged_points);
  EXPECT_EQ(buckets.counts().source_points, set.source_points);
  EXPECT_EQ(buckets.counts().left_out.total(), set.left_out_points);
  EXPECT_EQ(buckets.counts().largest_shift_plan, set.largest_shift_plan);
  EXPECT_EQ(buckets.counts().largest_shift_height, set.largest_shift_height);
  EXPECT_EQ(buckets.frame().map, set.frame.map);
  EXPECT_EQ(buckets.frame().heights, set.frame.heights);
  EXPECT_EQ(buckets.frame().min_height, set.frame.min_height);
  EXPECT_EQ(buckets.frame().max_height, set.frame.max_height);
  EXPECT_EQ(buckets.frame().height_quantum, set.frame.height_quantum);
  std::vector<BucketPoint> points;
  buckets.take(0, buckets.size(), points);
  for (std::uint64_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(contains(buckets.box(buckets.bucket_of(i)), points[i].position));
  }
  std::sort(points.begin(), points.end(), [](const BucketPoint& a, const BucketPoint& b) {
    return key_of(a.position) < key_of(b.position);
  });
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].position, set.positions[i]);
    ASSERT_EQ(points[i].height, set.heights[i]);
  }
}

TEST(PointBuckets, HoldThePointsOfTheSource) {
  for (const PointKind kind : test::some_of(kPointKinds)) {
    const MemoryFile file("set.xyz", text_of(points_of(kind, 30'000, 5)));
    SourceOptions options;
    for (const std::uint64_t memory : {std::uint64_t{1} << 16, std::uint64_t{1} << 26}) {
      SCOPED_TRACE(name_of(kind));
      expect_same(file.path(), options, memory);
      expect_same(file.path(), options, memory, small_sorting());
    }
    options.resolution = 7.0;
    for (const PointMerge rule :
         test::some_of({PointMerge::kLowest, PointMerge::kHighest, PointMerge::kFirst})) {
      options.merge = rule;
      expect_same(file.path(), options, 1 << 18);
      expect_same(file.path(), options, 1 << 16, small_sorting());
    }
  }
}

TEST(PointBuckets, KeepHeightsThatAreNoCodes) {
  std::string text = "0 0 0.123456789012\n0 5 1e-15\n";
  for (int i = 0; i < 5000; ++i) {
    text += std::to_string(i % 70) + ".5 " + std::to_string(i % 90) + " 12" +
            std::to_string(i * i % 1000003) + ".12345678901\n";
  }
  const MemoryFile file("set.xyz", text);
  expect_same(file.path(), {}, 1 << 16);
  expect_same(file.path(), {}, 1 << 16, small_sorting());
}

TEST(PointBuckets, ReadARealScanWithinLittleMemory) {
  const std::string path = std::string(PTIN_SHARED_DATA) + "/isprs_fsite8.xyz.gz";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "needs " << path;
  }
  expect_same(path, {}, 1 << 20);
}

TEST(PointBuckets, RefuseWhatHasNoArea) {
  for (const char* text : {"", "0 0 1\n", "0 0 1\n1 1 1\n0 0 2\n", "0 0 1\n5 5 1\n9 9 1\n"}) {
    const MemoryFile file("set.xyz", text);
    EXPECT_THROW(std::ignore = read_buckets({file.path()}), Error) << text;
  }
}

TEST(PointSource, SaysThatAFolderIsMissing) {
  const MemoryFile file("set.xyz", text_of(points_of(PointKind::kEven, 5000, 1)));
  EXPECT_THROW(PointSource({file.path()}, {}, {{FileLayer::system(), "/nowhere"}, run_told(0)}),
               Error);
}

TEST(PointSource, StopsInEveryStageAndLeavesNothingBehind) {
  const MemoryFile file("set.xyz", text_of(points_of(PointKind::kEven, 5000, 1)));
  for (const TaskKind kind : {TaskKind::kRead, TaskKind::kShare, TaskKind::kSort}) {
    const std::string at = stage_of(kind);
    SCOPED_TRACE(at);
    const oracle::ScratchFolder folder, kept;
    std::stop_source stop;
    const auto progress = [&](const StageProgress& told) {
      if (told.stage == at) {
        stop.request_stop();
      }
    };
    const auto sort = [&] {
      PointSource source(
          {file.path()}, {},
          {{FileLayer::system(), folder.path()}, run_told(0, stop.get_token(), progress)});
      std::ignore = source.sort(kept.file("buckets"), true);
    };
    EXPECT_THROW(sort(), Error);
    EXPECT_EQ(folder.names(), std::vector<std::string>{});
  }
}

RC_GTEST_PROP(PointOrder, LeadsThereAndBack, ()) {
  const auto largest = *rc::gen::oneOf(rc::gen::inRange<std::int64_t>(0, 50),
                                       rc::gen::inRange<std::int64_t>(0, kGridMax + 1LL),
                                       rc::gen::just<std::int64_t>(kGridMax));
  const PointOrder order(largest);
  for (int i = 0; i < 50; ++i) {
    const GridPoint p{static_cast<std::int32_t>(*rc::gen::inRange<std::int64_t>(0, largest + 1)),
                      static_cast<std::int32_t>(*rc::gen::inRange<std::int64_t>(0, largest + 1))};
    RC_ASSERT(order.point(order.key(p)) == p);
  }
  const auto end = static_cast<std::int32_t>(largest);
  RC_ASSERT(order.point(order.key({end, end})) == (GridPoint{end, end}));
}

/// True when no point lies to the right of a -> b: the definition.
bool is_border(const std::vector<GridPoint>& points, GridPoint a, GridPoint b) {
  return std::all_of(points.begin(), points.end(),
                     [&](GridPoint p) { return orient(a, b, p) >= 0; });
}

RC_GTEST_PROP(ConvexHull, KnowsItsBorder, ()) {
  const int size = *rc::gen::element(4, 30, 100'000'000);
  std::vector<GridPoint> points;
  HullCollector collector;
  for (int i = *rc::gen::inRange(3, 60); i > 0; --i) {
    points.push_back({*rc::gen::inRange(0, size), *rc::gen::inRange(0, size)});
    collector.add(points.back());
  }
  const ConvexHull hull = collector.hull();
  RC_PRE(hull.corners().size() >= 3);
  for (const GridPoint a : points) {
    for (const GridPoint b : points) {
      if (a != b) {
        RC_ASSERT(hull.has_on_border(a, b) == is_border(points, a, b));
      }
    }
  }
}

TEST(ConvexHull, OfManyPointsIsThatOfAll) {
  for (const PointKind kind : {PointKind::kEven, PointKind::kRing, PointKind::kCorridor}) {
    const std::vector<GridPoint> points = points_of(kind, 40'000, 3);
    HullCollector collector;
    for (const GridPoint p : points) {
      collector.add(p);
    }
    const std::vector<GridPoint> corners = collector.hull().corners();
    for (std::size_t i = 0; i < corners.size(); i += 1 + corners.size() / 100) {
      EXPECT_TRUE(is_border(points, corners[i], corners[(i + 1) % corners.size()]));
    }
  }
}

}  // namespace
}  // namespace ptin
