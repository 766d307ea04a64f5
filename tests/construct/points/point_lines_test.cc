// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points with lines: on which grid, what is merged, what is refused.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/grid/decimal.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/read_buckets.h"

namespace ptin {
namespace {

SourceLines line_of(const std::vector<std::array<double, 3>>& vertices,
                    const std::string& crs = "") {
  SourceLines lines;
  for (const auto& v : vertices) {
    lines.breaklines.vertices.push_back({decimal_of(v[0]), decimal_of(v[1]), decimal_of(v[2])});
  }
  lines.breaklines.ends.push_back(vertices.size());
  lines.files.push_back({"lines", crs, {}});
  return lines;
}

PointBuckets read(const std::string& points, const SourceLines& lines, SourceOptions options = {}) {
  const MemoryFile file("points.xyz", points);
  options.lines = &lines;
  return read_buckets({file.path()}, options);
}

std::string refusal_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

constexpr const char* kSquare = "0 0 1\n10 0 2\n0 10 3\n10 10 4\n";

TEST(PointLines, KeepTwoDigitsOfALineOrAsManyAsPointsHave) {
  const SourceLines fine = line_of({{1.2345, 2.5, 1.126}, {7.0, 8.0, 2.0}});
  const PointBuckets whole = read(kSquare, fine);
  EXPECT_EQ(whole.frame().map.step_x, 0.01);
  EXPECT_EQ(whole.frame().heights.step, 0.01);
  EXPECT_EQ(whole.fixed_edges().vertices()[0].position, (GridPoint{123, 250}));
  EXPECT_EQ(whole.fixed_edges().vertices()[0].height, 113.0);
  EXPECT_NEAR(whole.counts().largest_shift_plan, 0.0045, 1e-12);
  const PointBuckets finer = read("0.001 0 1\n10 0 2\n0 10 3.0004\n10 10 4\n", fine);
  EXPECT_EQ(finer.frame().map.step_x, 0.001);
  EXPECT_EQ(finer.frame().heights.step, 0.0001);
  EXPECT_EQ(read(kSquare, line_of({{1, 2, 3}, {4, 4, 4}})).frame().map.step_x, 1.0);
}

TEST(PointLines, RoundHalvesAwayFromZero) {
  const PointBuckets buckets = read("-1 -1 0\n1 -1 0\n-1 1 0\n1 1 0\n",
                                    line_of({{-0.125, -0.124, -0.125}, {0.125, 0.126, 0.125}}));
  const auto vertices = buckets.fixed_edges().vertices();
  EXPECT_EQ(vertices[0].position, (GridPoint{87, 88}));
  EXPECT_EQ(vertices[1].position, (GridPoint{113, 113}));
  EXPECT_EQ(vertices[0].height, -13.0);
  EXPECT_EQ(vertices[1].height, 13.0);
}

TEST(PointLines, StandWherePointsFallOnTheirVertices) {
  for (const PointMerge rule : {PointMerge::kMean, PointMerge::kFirst, PointMerge::kHighest}) {
    SourceOptions options;
    options.merge = rule;
    const PointBuckets buckets =
        read(std::string(kSquare) + "5 5 90\n5 5 91\n", line_of({{5, 5, 7}, {0, 0, 8}}), options);
    EXPECT_EQ(buckets.size(), 5U);
    EXPECT_EQ(buckets.counts().merged_points, 3U);  // 5 5 twice and 0 0, of 8 with the vertices
    std::vector<BucketPoint> points;
    buckets.take(0, buckets.size(), points);
    for (const BucketPoint& p : points) {
      const double height = buckets.frame().heights.height(p.height);
      if (p.position == GridPoint{5, 5}) {
        EXPECT_EQ(height, 7.0);
      } else if (p.position == GridPoint{0, 0}) {
        EXPECT_EQ(height, 8.0);
      }
    }
  }
}

TEST(PointLines, AreRefusedInAnotherCrsThanThePoints) {
  const auto refusal = [](const std::string& crs, const std::string& a_srs) {
    SourceOptions options;
    options.a_srs = a_srs;
    return refusal_of([&] { read(kSquare, line_of({{5, 5, 7}, {0, 0, 8}}, crs), options); });
  };
  EXPECT_NE(refusal("EPSG:32632", "").find("another CRS"), std::string::npos);
  SourceOptions options;
  options.a_srs = "EPSG:32632";
  EXPECT_EQ(read(kSquare, line_of({{5, 5, 7}, {0, 0, 8}}, "EPSG:25832"), options).size(), 5U);
}

TEST(PointLines, AreRefusedWithoutAHeightOrFarFromThePoints) {
  SourceOptions options;
  options.nodata = -9999.0;
  EXPECT_NE(refusal_of([&] {
              read(kSquare, line_of({{5, 5, 7}, {2, 2, -9999}}), options);
            }).find("the height that means none"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] {
              read(kSquare, line_of({{50, 5, 7}, {20, 2, 1}}));
            }).find("lies where the points do"),
            std::string::npos);
}

TEST(PointLines, AreKeptWithTheBuckets) {
  const oracle::ScratchFolder folder;
  const MemoryFile file("points.xyz", kSquare);
  const SourceLines lines = line_of({{1.5, 2.5, 1}, {7.25, 8.5, 2}, {9, 1, 3}});
  SourceOptions options;
  options.lines = &lines;
  PointSource source({file.path()}, options,
                     {{FileLayer::system(), folder.path()}, run_told(1 << 20)});
  const PointBuckets read = source.sort(folder.file("buckets"), true);
  const ArrayFileFacts facts = read.save(FileLayer::system(), folder.file("index"));
  const PointBuckets loaded =
      PointBuckets::load(FileLayer::system(), folder.file("buckets"), folder.file("index"), facts);
  ASSERT_EQ(loaded.fixed_edges().edges().size(), 2U);
  for (std::uint32_t v = 0; v < 3; ++v) {
    EXPECT_EQ(loaded.fixed_edges().vertices()[v].position,
              read.fixed_edges().vertices()[v].position);
    EXPECT_EQ(loaded.fixed_height(v), read.fixed_height(v));
  }
}

}  // namespace
}  // namespace ptin
