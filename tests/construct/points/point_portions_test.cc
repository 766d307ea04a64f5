// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files of points are read in portions, wherever they are cut, as they are read as a whole.
#include "engine/construct/points/point_portions.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/points/open_points.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/read_buckets.h"
#include "tests/support/las_file.h"

namespace ptin {
namespace {

using Triple = std::array<Decimal, 3>;

std::vector<Triple> points_of_part(const std::string& path, const PointPart& part) {
  const auto stream = open_point_stream(path, {}, {}, {}, part);
  std::vector<Triple> all;
  std::vector<SourcePoint> batch;
  while (stream->next(batch)) {
    for (const SourcePoint& p : batch) {
      all.push_back({p.x, p.y, p.z});
    }
  }
  return all;
}

/// Every point of a file is in exactly one of two parts, wherever it is cut.
void expect_cut_anywhere(const std::string& path, std::uint64_t size) {
  const std::vector<Triple> whole = points_of_part(path, {});
  for (std::uint64_t at = 1; at <= size + 1; ++at) {
    std::vector<Triple> both = points_of_part(path, {0, at});
    const std::vector<Triple> behind = points_of_part(path, {at, PointPart{}.end});
    both.insert(both.end(), behind.begin(), behind.end());
    ASSERT_EQ(both, whole) << "cut at " << at;
  }
}

TEST(PointPortions, OfTextHaveEveryRowOnce) {
  for (const char* text : {"0 0 1\n5 5 2\n9 1 3\n", "0 0 1\r\n5 5 2\r\n9 1 3",
                           "x,y,z\n0,0,1\n\n\n5,5,2\n# no\n9,1,3\n\n",
                           "\n\n# first\n\"x\" \"y\" \"z\"\n0 0 1\n5 5 2\n",
                           "\xEF\xBB\xBF"
                           "0 0 1\n5 5 2\n",
                           "0 0 1\n", ""}) {
    SCOPED_TRACE(text);
    const MemoryFile file("portions.xyz", text);
    expect_cut_anywhere(file.path(), std::string(text).size());
  }
}

TEST(PointPortions, BeyondTheBufferOfTheReaderHaveEveryRowOnce) {
  std::string text;
  while (text.size() < (std::size_t{5} << 19)) {
    text += std::to_string(text.size()) + " 5.25 1\n";
  }
  const MemoryFile file("portions.xyz", text);
  const std::vector<Triple> whole = points_of_part(file.path(), {});
  std::vector<Triple> all;
  constexpr std::uint64_t kStep = 700'001;
  for (std::uint64_t at = 0; at < text.size(); at += kStep) {
    const std::vector<Triple> part = points_of_part(file.path(), {at, at + kStep});
    all.insert(all.end(), part.begin(), part.end());
  }
  EXPECT_EQ(all, whole);
}

TEST(PointPortions, OfLasHaveEveryRecordOnce) {
  LasFileMaker las;
  for (std::int32_t i = 0; i < 37; ++i) {
    las.points.push_back({i * 7, i * i, 100 - i, i % 5, i % 6 == 0});
  }
  const MemoryFile file("portions.las", las.bytes());
  expect_cut_anywhere(file.path(), 37);
}

/// What a build of these files makes of them, or why it refuses.
std::string told_of(const std::vector<std::string>& paths, std::uint64_t text_bytes,
                    std::uint64_t las_records, const SourceOptions& options = {}) {
  const oracle::ScratchFolder folder(oracle::ScratchFolder::Size::kSmall);
  PointWork work{{FileLayer::system(), folder.path()}, run_told(1 << 20), {}, 0};
  work.portions = {text_bytes, las_records};
  try {
    PointSource source(paths, options, work);
    const PointBuckets buckets = source.sort(folder.file("buckets"), true);
    std::vector<BucketPoint> points;
    buckets.take(0, buckets.size(), points);
    std::string told = std::to_string(buckets.counts().source_points) + "/" +
                       std::to_string(buckets.counts().left_out.total());
    for (const BucketPoint& p : points) {
      told += " " + std::to_string(p.position.x) + "," + std::to_string(p.position.y) + "," +
              std::to_string(p.height);
    }
    for (const std::uint64_t input : buckets.empty_inputs()) {
      told += " empty " + std::to_string(input);
    }
    for (const SourceWarning& w : buckets.warnings().all()) {
      told += " " + w.kind + " at " + std::to_string(w.line) + ", " + std::to_string(w.count) +
              " of " + w.message;
    }
    return told;
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(PointPortions, OfAnySizeMakeTheSame) {
  const std::string with_quotes =
      "x,y,z,name\n0,0,1,\"a\nb\"\n5,0,2,\"1,2,3,4\n5,6,7,8\n\"\n0,5,3,c\n";
  for (const std::string& text :
       {std::string("0 0 1\n5 0 2\r\n0 5 3\n5 5 4\n5 5 6\n7 1 4.5"), with_quotes,
        with_quotes + "0,5,3,\"open\n", std::string("0 0 1\n5 0 2\n0 5 3\n5 5 bad\n9 9 1\n1 1\n"),
        std::string("1 0.5 0 1\n2 5 0 2\n3 0 5 3\n4 5 5 4\n"),
        std::string("1 0.5 0\n2 5.5 2\n3 0 5.25\n4 5 5\n"),
        std::string("1 0.5 0 1\n2 5 0 2\n\n# a\n7 0 5 3\n4 5 5 4\n"), std::string("0 0\n5 0 1\n"),
        std::string("x y\n0 0\n")}) {
    SCOPED_TRACE(text);
    const MemoryFile file("portions.csv", text);
    const std::string whole = told_of({file.path()}, 1 << 20, 1);
    for (std::uint64_t bytes = 1; bytes <= text.size(); ++bytes) {
      ASSERT_EQ(told_of({file.path()}, bytes, 1), whole) << bytes << " bytes";
    }
  }
}

TEST(PointPortions, TellTheSameRowsThatAreNoPoints) {
  const std::string text =
      "0 0 1\n\n5 0 2\n# a\n0 5 nan\n0 5 3\n7 7\n5 5 bad\n9 9 1 4\n1e20 1 1\n5 5 4";
  const MemoryFile file("portions.xyz", text);
  SourceOptions options;
  options.points.skip_invalid = true;
  const std::string whole = told_of({file.path()}, 1 << 20, 1, options);
  EXPECT_TRUE(whole.starts_with("4/5 ")) << whole;
  EXPECT_NE(whole.find("invalid_rows at 5, 5 of "), std::string::npos) << whole;
  for (std::uint64_t bytes = 1; bytes <= text.size(); ++bytes) {
    ASSERT_EQ(told_of({file.path()}, bytes, 1, options), whole) << bytes << " bytes";
  }
  EXPECT_NE(told_of({file.path()}, 1 << 20, 1).find("--skip-invalid"), std::string::npos);
}

TEST(PointPortions, OfLasMakeTheSame) {
  LasFileMaker las;
  for (std::int32_t i = 0; i < 23; ++i) {
    las.points.push_back({i * 7 % 11, i * i % 13, 100 - i, i % 5, i % 6 == 0});
  }
  const MemoryFile file("portions.las", las.bytes()), text("portions.xyz", "0.01 0.02 3\n");
  SourceOptions options;
  options.merge = PointMerge::kFirst;
  options.points.returns = ReturnChoice::kAll;
  const std::vector<std::string> paths{file.path(), text.path()};
  const std::string whole = told_of(paths, 1, 100, options);
  EXPECT_TRUE(whole.starts_with("20/4 ")) << whole;
  for (std::uint64_t records = 1; records <= 23; ++records) {
    ASSERT_EQ(told_of(paths, 1, records, options), whole);
  }
}

TEST(PointPortions, OfSeveralFilesMayBeEmpty) {
  const MemoryFile a("a.xyz", "0 0 1\n5 0 2\n100 100 3\n"), b("b.xyz", ""),
      c("c.xyz", "200 200 1\n300 300 2\n"), d("d.xyz", "0 5 3\n");
  SourceOptions options;
  options.bbox = SourceOptions::Bounds{-1, -1, 10, 10};
  options.merge = PointMerge::kFirst;
  const std::vector<std::string> paths{a.path(), b.path(), c.path(), d.path()};
  const std::string whole = told_of(paths, 1 << 20, 1, options);
  EXPECT_TRUE(whole.starts_with("3/3 ")) << whole;
  EXPECT_EQ(told_of(paths, 1, 1, options), whole);
  EXPECT_NE(whole.find(" empty 1"), std::string::npos)
      << whole;  // not the third, left out as it is
}

TEST(PointPortions, OfFilesWithoutAPointAreRefused) {
  const MemoryFile empty("empty.xyz", ""), other("other.xyz", "5 5 5\n");
  EXPECT_NE(told_of({empty.path()}, 1, 1).find("there is no point in this file"),
            std::string::npos);
  SourceOptions options;
  options.bbox = SourceOptions::Bounds{-1, -1, 1, 1};
  EXPECT_NE(told_of({empty.path(), other.path()}, 1, 1, options).find("every point is left out"),
            std::string::npos);
}

}  // namespace
}  // namespace ptin
