// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/point_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "tests/construct/delaunay_tin.h"
#include "tests/construct/memory_file.h"

namespace ptin {
namespace {

PointSet read(const std::string& text, const SourceOptions& options = {}) {
  const MemoryFile file("points.xyz", text);
  return read_points({file.path()}, options);
}

std::vector<double> heights_of_set(const PointSet& set) {
  std::vector<double> heights;
  for (HeightBits bits : set.heights) {
    heights.push_back(set.frame.heights.height(bits));
  }
  return heights;
}

using Positions = std::vector<GridPoint>;
using Heights = std::vector<double>;

void expect_source_refused(const std::string& text, const std::string& word,
                           const SourceOptions& options = {}) {
  try {
    std::ignore = read(text, options);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
    EXPECT_EQ(e.context(), "/vsimem/points.xyz");
  }
}

TEST(PointSource, KeepsEveryDigitOfThePlan) {
  const PointSet set = read("100.25 7 1\n100 7.5 2\n101.125 8 3\n");
  EXPECT_EQ(set.frame.map, (AffineMap{100, 7, 0.001, 0.001}));
  EXPECT_EQ(set.positions, (Positions{{250, 0}, {0, 500}, {1125, 1000}}));
  EXPECT_EQ(set.largest_shift_plan, 0);
  EXPECT_EQ(set.source_points, 3U);
  EXPECT_EQ(set.merged_points, 0U);
}

TEST(PointSource, KeepsEveryDigitOfHeights) {
  const PointSet set = read("0 0 -12.25\n1 0 8848.86\n0 1 3\n");
  EXPECT_EQ(set.frame.heights, (HeightEncoding{HeightType::int32, 0.01, 0}));
  EXPECT_EQ(set.frame.height_quantum, 0.01);
  EXPECT_EQ(set.frame.height_rounding, 0);
  EXPECT_EQ(heights_of_set(set), (Heights{-1225 * 0.01, 884886 * 0.01, 300 * 0.01}));
  EXPECT_EQ(set.frame.min_height, -12.25);
}

TEST(PointSource, RoundsHeightsWithMoreDigitsThanFit) {
  const PointSet set = read("0 0 -12.123456789\n1 0 8848.86\n0 1 3\n");
  EXPECT_EQ(set.frame.heights.type, HeightType::int32);
  EXPECT_GT(set.frame.height_rounding, 0);
  EXPECT_LT(set.frame.height_rounding, 1e-5);
  EXPECT_NEAR(heights_of_set(set)[0], -12.123456789, set.frame.height_rounding);
}

TEST(PointSource, SnapsToAResolution) {
  SourceOptions options;
  options.resolution = 0.5;
  const PointSet set = read("100.2 7 1\n100.9 7.26 2\n103 9 3\n", options);
  EXPECT_EQ(set.frame.map, (AffineMap{100, 7, 0.5, 0.5}));
  EXPECT_EQ(set.positions, (Positions{{0, 0}, {2, 1}, {6, 4}}));
  EXPECT_NEAR(set.largest_shift_plan, std::hypot(0.1, 0.24), 1e-9);
  options.resolution = 0;
  expect_source_refused("0 0 0\n1 0 0\n0 1 0\n", "resolution must be", options);
}

TEST(PointSource, SnapsNegativeCoordinatesLikeOthers) {
  SourceOptions options;
  options.resolution = 10;
  const PointSet set = read("-14 -26 1\n-6 4 2\n16 4 3\n", options);
  EXPECT_EQ(set.frame.map, (AffineMap{-10, -30, 10, 10}));
  EXPECT_EQ(set.positions, (Positions{{0, 0}, {0, 3}, {3, 3}}));
}

TEST(PointSource, DropsTheDigitsThatTheGridDoesNotKeep) {
  const PointSet fine = read("0 0 0\n1000000 0 0\n0 0.0014 0\n0 5 0\n");
  EXPECT_EQ(fine.frame.map.step_x, 0.001);
  EXPECT_EQ(fine.positions.size(), 4U);
  EXPECT_EQ(fine.largest_shift_plan, 0.0004);
  const PointSet set = read("0 0 0\n1000000 0 0\n0 0.0001 0\n0 5 0\n");
  EXPECT_EQ(set.frame.map.step_x, 1) << "of the rounded digits none is left";
  EXPECT_EQ(set.positions.size(), 3U);
  EXPECT_EQ(set.largest_shift_plan, 0.0001);
  expect_source_refused("0 0 0\n123456789012345678 0 0\n0 1e-18 0\n", "2^30");
  SourceOptions options;
  options.resolution = 0.001;
  EXPECT_EQ(read("0 0 0\n1000000 0 0\n0 0.0001 0\n0 5 0", options).positions.size(), 3U);
}

TEST(PointSource, HoldsTheLargestExtent) {
  const PointSet set = read("0 0 0\n1073741824 0 0\n0 1073741824 0\n");
  EXPECT_EQ(set.positions.back(), (GridPoint{0, kGridMax}));
  expect_source_refused("0 0 0\n1073741825 0 0\n0 1 0\n", "2^30");
}

TEST(PointSource, MergesPointsThatFallTogether) {
  const std::string text = "0 0 1.0\n5 0 2\n0 5 3\n0 0 1.4\n0 0 1.4\n";
  PointSet set = read(text);
  EXPECT_EQ(set.source_points, 5U);
  EXPECT_EQ(set.merged_points, 2U);
  EXPECT_EQ(set.positions.size(), 3U);
  EXPECT_NEAR(heights_of_set(set)[0], 1.3, 1e-12) << "the mean, 1.2666, rounded to the step";
  EXPECT_NEAR(set.largest_shift_height, 0.3, 1e-12);
  SourceOptions options;
  options.merge = PointMerge::kLowest;
  EXPECT_NEAR(heights_of_set(read(text, options))[0], 1.0, 1e-12);
  options.merge = PointMerge::kHighest;
  set = read(text, options);
  EXPECT_NEAR(heights_of_set(set)[0], 1.4, 1e-12);
  EXPECT_NEAR(set.largest_shift_height, 0.4, 1e-12);
}

TEST(PointSource, LeavesOutPointsBeyondTheBoundsOrWithoutAHeight) {
  SourceOptions options;
  options.bbox = {0, 0, 10, 10};
  options.nodata = -9999;
  const PointSet set = read("0 0 1\n10 0 2\n0 10 3\n11 0 4\n5 5 -9999.00\n", options);
  EXPECT_EQ(set.source_points, 3U);
  options.bbox = {100, 100, 200, 200};
  expect_source_refused("0 0 1\n10 0 2\n0 10 3\n", "every point is left out", options);
}

TEST(PointSource, RefusesWhatHasNoArea) {
  expect_source_refused("", "no point");
  expect_source_refused("0 0 1\n1 0 1\n", "2 distinct points");
  expect_source_refused("0 0 1\n1 0 1\n0 0 5\n1 0 2\n", "2 distinct points");
  expect_source_refused("0 0 1\n1 1 1\n5 5 5\n100 100 2\n", "one line");
}

TEST(PointSource, TakesItsCrsFromTheCaller) {
  SourceOptions options;
  options.a_srs = "EPSG:2994";
  options.vertical_crs = "EPSG:6360";
  const PointSet set = read("0 0 1\n10 0 2\n0 10 3\n", options);
  EXPECT_EQ(set.frame.horizontal_unit, "foot");
  EXPECT_TRUE(set.frame.vertical_crs_known);
  EXPECT_EQ(read("0 0 1\n10 0 2\n0 10 3\n").frame.crs_wkt, "");
}

TEST(PointSource, JoinsSeveralFiles) {
  const MemoryFile a("a.csv", "x,y,z\n0,0,1\n1,0,2\n"), b("b.xyz", "0 1.5 3\n");
  const PointSet set = read_points({a.path(), b.path()}, {});
  EXPECT_EQ(set.frame.map.step_x, 0.1);
  EXPECT_EQ(set.positions, (Positions{{0, 0}, {10, 0}, {0, 15}}));
}

TEST(PointSource, KnowsTheNamesOfPointFiles) {
  for (const char* name :
       {"a.csv", "b/A.XYZ", "c.txt", "d.tsv", "e.csv.gz", "f.XYZ.GZ", "c.las", "D.LAZ"}) {
    EXPECT_EQ(kind_by_name(name), InputKind::kPoints) << name;
  }
  for (const char* name : {"a.tif", "xyz", "b.gz", "c.las.gz", ""}) {
    EXPECT_EQ(kind_by_name(name), std::nullopt) << name;
  }
}

TEST(PointSource, StopsWhenAskedAndReportsProgress) {
  std::string text;
  for (int i = 0; i < 70'000; ++i) {
    text += std::to_string(i % 300) + " " + std::to_string(i / 300) + " 1\n";
  }
  const MemoryFile file("many.xyz", text);
  std::stop_source stop;
  std::uint64_t reported = 0;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(total, text.size());
    EXPECT_LE(done, total);
    reported = done;
  };
  EXPECT_EQ(read_points({file.path()}, {}, stop.get_token(), progress).positions.size(), 70'000U);
  EXPECT_GT(reported, 0U);
  stop.request_stop();
  EXPECT_THROW(std::ignore = read_points({file.path()}, {}, stop.get_token()), Error);
}

RC_GTEST_PROP(PointSource, DependsOnTheSetOfPointsAlone, ()) {
  std::vector<std::string> lines{"0 0 0", "7 0.5 1", "0 9 2"};
  const int n = *rc::gen::inRange(0, 40);
  const int digits = *rc::gen::element(1, 6, 12);
  for (int i = 0; i < n; ++i) {
    lines.push_back(std::to_string(*rc::gen::inRange(0, 4)) + " " +
                    std::to_string(*rc::gen::inRange(0, 4)) + " 123." +
                    std::to_string(*rc::gen::inRange<long>(1, 1000000)).substr(0, digits) +
                    (digits == 12 ? "1234567" : ""));
  }
  const auto joined = [](const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& line : all) {
      text += line + "\n";
    }
    return text;
  };
  auto shuffled = lines;
  for (std::size_t i = shuffled.size(); i > 1; --i) {
    std::swap(shuffled[i - 1], shuffled[*rc::gen::inRange<std::size_t>(0, i)]);
  }
  const PointSet a = read(joined(lines)), b = read(joined(shuffled));
  RC_ASSERT(a.positions == b.positions);
  RC_ASSERT(a.heights == b.heights);
  RC_ASSERT(a.frame.heights == b.frame.heights);
  RC_ASSERT(a.largest_shift_height == b.largest_shift_height);
  RC_ASSERT(a.source_points == lines.size());
  RC_ASSERT(a.merged_points + a.positions.size() == a.source_points);
}

TEST(PointSourceOnRealTerrain, TriangulatesGroundPoints) {
  const std::string path = std::string(PTIN_TEST_DATA) + "/ground_points.csv";
  SourceOptions options;
  options.a_srs = "EPSG:2994";
  const PointSet set = read_points({path}, options);
  EXPECT_EQ(set.source_points, 5004U);
  EXPECT_EQ(set.merged_points, 0U);
  EXPECT_EQ(set.frame.map.step_x, 0.01);
  EXPECT_EQ(set.frame.heights, (HeightEncoding{HeightType::int32, 0.01, 0}));
  const Tin tin = make_delaunay_tin(set.positions, set.heights);
  EXPECT_EQ(validate(tin), "");
}

TEST(PointSourceOnRealTerrain, CountsTheDuplicatesOfAScan) {
  const std::string path = std::string(PTIN_SHARED_DATA) + "/isprs_fsite8.xyz.gz";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << path << " is not here";
  }
  const PointSet set = read_points({path}, {});
  EXPECT_EQ(set.source_points, 345'966U);
  EXPECT_EQ(set.positions.size(), 195'273U);
  EXPECT_NEAR(set.frame.min_height, 241.67, 1e-9);
  EXPECT_NEAR(set.frame.max_height, 888.22, 1e-9);
  EXPECT_GT(set.largest_shift_height, 1);
}

}  // namespace
}  // namespace ptin
