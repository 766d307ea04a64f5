// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_reader.h"

#include <filesystem>
#include <limits>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/error.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/point_source.h"
#include "tests/support/las_file.h"

namespace ptin {
namespace {

std::vector<SourcePoint> points_of(const std::string& bytes, const std::vector<int>& classes = {}) {
  const MemoryFile file("made.las", bytes);
  PointChoice choice;
  choice.classes = classes;
  LasReader reader(file.path(), choice);
  std::vector<SourcePoint> all, batch;
  while (reader.next(batch)) {
    EXPECT_FALSE(batch.empty());
    all.insert(all.end(), batch.begin(), batch.end());
  }
  EXPECT_EQ(reader.done(), reader.total());
  EXPECT_EQ(reader.left_out().total() + all.size(), reader.total());
  return all;
}

void expect_las_refused(const std::string& bytes, const std::string& word,
                        ErrorCode code = ErrorCode::invalid_argument) {
  try {
    std::ignore = points_of(bytes);
    FAIL() << "accepted; " << word;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
    EXPECT_EQ(e.context(), "/vsimem/made.las");
  }
}

LasFileMaker three_points() {
  LasFileMaker las;
  las.points = {{0, 0, 100, 2}, {1050, 0, 200, 1}, {-7, 1000, -300, 2}};
  return las;
}

TEST(LasReader, ReadsEveryPointFormatOfEveryVersion) {
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= 10; ++format) {
      LasFileMaker las = three_points();
      las.minor = minor;
      las.format = format;
      las.extra_bytes = format * 3;
      las.points.push_back({5, 5, 5, 7, true});
      const auto points = points_of(las.bytes());
      ASSERT_EQ(points.size(), 3U) << "one is withheld";
      EXPECT_EQ(points[1].x, (Decimal{1050, 2}));
      EXPECT_EQ(points[2].x, (Decimal{-7, 2}));
      EXPECT_EQ(points[2].y, (Decimal{1000, 2}));
      EXPECT_EQ(points[2].z, (Decimal{-300, 2}));
    }
  }
}

TEST(LasReader, KeepsTheChosenClasses) {
  LasFileMaker las;
  for (int c = 0; c < 256; ++c) {
    las.points.push_back({c, c, c, c});
  }
  las.minor = 4;
  las.format = 6;
  EXPECT_EQ(points_of(las.bytes(), {2}).size(), 1U);
  EXPECT_EQ(points_of(las.bytes(), {2, 65, 255}).back().x.mantissa, 255);
  EXPECT_EQ(points_of(las.bytes()).size(), 256U);
  las.points.resize(32);
  las.format = 3;
  las.minor = 2;
  EXPECT_EQ(points_of(las.bytes(), {31, 2}).size(), 2U);
  EXPECT_THROW(std::ignore = points_of(las.bytes(), {256}), Error);
  EXPECT_THROW(std::ignore = points_of(las.bytes(), {-1}), Error);
}

TEST(LasReader, KeepsTheChosenReturns) {
  // Of pulses with one echo, two and five; of one whose echoes are not numbered.
  LasFileMaker las;
  for (const auto& [number, returns] :
       {std::pair{1, 1}, {1, 2}, {2, 2}, {1, 5}, {3, 5}, {5, 5}, {0, 0}}) {
    las.points.push_back({0, 0, 10 * number + returns, 2, false, number, returns});
  }
  const std::vector<std::int64_t> first = {11, 12, 15, 0}, last = {11, 22, 55, 0};
  for (const int format : {0, 3, 5, 6, 10}) {
    las.minor = 4;
    las.format = format;
    const MemoryFile file("made.las", las.bytes());
    for (const auto& [returns, expected] :
         {std::pair{ReturnChoice::kFirst, first}, {ReturnChoice::kLast, last}}) {
      PointChoice choice;
      choice.returns = returns;
      LasReader reader(file.path(), choice);
      std::vector<SourcePoint> batch;
      ASSERT_TRUE(reader.next(batch));
      std::vector<std::int64_t> heights;
      for (const SourcePoint& p : batch) heights.push_back(p.z.mantissa);
      EXPECT_EQ(heights, expected) << format;
      EXPECT_EQ(reader.left_out().total(), 3U);
    }
  }
}

TEST(LasReader, AddsTheOffsetExactly) {
  LasFileMaker las = three_points();
  las.scale = {0.001, 0.001, 0.25};
  las.offset = {638000, -849123.5, 0.5};
  const auto points = points_of(las.bytes());
  EXPECT_EQ(points[1].x, (Decimal{638001050, 3}));
  EXPECT_EQ(points[1].y, (Decimal{-849123500, 3}));
  EXPECT_DOUBLE_EQ(to_double(points[1].z), 50.5);
}

PointSet set_of(const LasFileMaker& las, const SourceOptions& options = {}) {
  const MemoryFile file("made.las", las.bytes());
  return read_points({file.path()}, options);
}

TEST(LasReader, ItsScaleIsTheGridOfTheTerrain) {
  const PointSet set = set_of(three_points());
  EXPECT_EQ(set.frame.map, (AffineMap{-0.07, 0, 0.01, 0.01})) << "0.1 would keep every digit";
  EXPECT_EQ(set.frame.heights, (HeightEncoding{HeightType::int32, 0.01, 0}));
  EXPECT_EQ(set.positions, (std::vector<GridPoint>{{7, 0}, {1057, 0}, {0, 1000}}));
}

TEST(LasReader, KeepsALatticeThatIsNotDecimal) {
  LasFileMaker las = three_points();
  las.scale = {0.3048 / 128, 0.3048 / 128, 0.01};
  las.offset = {500000.123456789, 4100000.3, 0};
  const PointSet set = set_of(las);
  EXPECT_EQ(set.positions, (std::vector<GridPoint>{{7, 0}, {1057, 0}, {0, 1000}}));
  EXPECT_LT(set.largest_shift_plan, 1e-8);
  EXPECT_EQ(set.frame.map.step_x, 0.3048 / 128);
  EXPECT_NEAR(set.frame.map.origin_x, las.offset[0] - 7 * las.scale[0], 1e-8);
}

TEST(LasReader, KeepsOfAnAutomaticScaleWhatTheGridCan) {
  LasFileMaker las;
  for (const int x : {-2147483647, -5, 2147483647}) {
    for (const int y : {-2147483647, 17, 2147483647}) las.points.push_back({x, y, x / 3});
  }
  const double step = 961.118788 / 4294967294.0;
  las.scale = {step, step, 40.0 / 4294967294.0};
  las.offset = {500480.559394, 4000480.559394, 20};
  const PointSet set = set_of(las);
  EXPECT_EQ(set.frame.map.step_x, 1e-6);
  EXPECT_EQ(set.positions.size(), 9U);
}

TEST(LasReader, RefusesWhatIsNoLas) {
  expect_las_refused("", "no LAS file");
  expect_las_refused("PK\3\4", "no LAS file");
  LasFileMaker las = three_points();
  las.format = 3;
  std::string laz = las.bytes();
  laz[104] = static_cast<char>(0x83);
  expect_las_refused(laz, "how the points are compressed is not there");
  std::string newer = las.bytes();
  newer[25] = 5;
  expect_las_refused(newer, "LAS 1.5", ErrorCode::unsupported_version);
  newer[24] = 77;
  expect_las_refused(newer, "LAS 77.5");
}

TEST(LasReader, RefusesDamagedHeaders) {
  const std::string good = three_points().bytes();
  for (std::size_t length = 4; length < good.size(); ++length) {
    expect_las_refused(good.substr(0, length), "damaged or cut off");
  }
  const auto with = [&](std::size_t at, auto value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
  };
  expect_las_refused(with(94, std::uint16_t{100}), "shorter than");
  expect_las_refused(with(96, std::uint32_t{100}), "said to begin");
  expect_las_refused(with(96, std::uint32_t{1U << 30}), "said to begin");
  expect_las_refused(with(104, std::uint8_t{11}), "point format 11");
  expect_las_refused(with(105, std::uint16_t{19}), "at least 20 bytes");
  expect_las_refused(with(107, std::uint32_t{4}), "and there are 3");
  expect_las_refused(with(131, 0.0), "scale factors");
  expect_las_refused(with(131, std::numeric_limits<double>::quiet_NaN()), "scale factors");
  expect_las_refused(with(155, 1e300), "coordinates below");
  expect_las_refused(with(163, -std::numeric_limits<double>::infinity()), "coordinates below");
}

TEST(LasReader, TakesTheCrsFromWkt) {
  const std::string wkt = resolve_crs("EPSG:2154", "", "").wkt;
  LasFileMaker las = three_points();
  las.minor = 4;
  las.format = 6;
  las.wkt_bit = true;
  for (const bool extended : {false, true}) {
    las.records = {{2112, wkt + std::string(3, '\0'), extended}};
    EXPECT_TRUE(is_same_crs(set_of(las).frame.crs_wkt, wkt));
  }
  las.records = {{2112, "PROJCS[rubbish", false}};
  EXPECT_EQ(set_of(las).frame.crs_wkt, "");
  SourceOptions options;
  options.a_srs = "EPSG:2154";
  EXPECT_TRUE(is_same_crs(set_of(las, options).frame.crs_wkt, wkt));
}

std::string keys(const std::vector<std::uint16_t>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * 2};
}

TEST(LasReader, TakesTheCrsFromGeoTiffKeys) {
  LasFileMaker las = three_points();
  las.records = {{34735, keys({1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632})}};
  EXPECT_TRUE(is_same_crs(set_of(las).frame.crs_wkt, resolve_crs("EPSG:32632", "", "").wkt));
  las.records[0].content.resize(20);
  EXPECT_EQ(set_of(las).frame.crs_wkt, "");
}

RC_GTEST_PROP(LasReader, NeverReadsBeyondADamagedFile, ()) {
  LasFileMaker las = three_points();
  las.minor = *rc::gen::element(2, 4);
  las.records = {{34735, keys({1, 1, 0, 1, 3072, 0, 1, 32632})}, {2112, "x"}};
  std::string bytes = las.bytes();
  for (int i = *rc::gen::inRange(1, 6); i > 0; --i) {
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
  }
  bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 1));
  try {
    std::ignore = points_of(bytes);
  } catch (const Error& e) {
    RC_ASSERT(e.code() != ErrorCode::internal);
  }
}

std::string shared(const char* name) { return std::string(PTIN_SHARED_DATA) + "/" + name; }

TEST(LasReaderOnRealTerrain, ReadsAnOldAndANewFile) {
  if (!std::filesystem::exists(shared("autzen_trim.las"))) {
    GTEST_SKIP() << "needs autzen_trim.las";
  }
  SourceOptions options;
  const PointSet old = read_points({shared("autzen_trim.las")}, options);
  EXPECT_EQ(old.source_points, 110'000U);
  EXPECT_EQ(old.merged_points, 7U);
  EXPECT_NEAR(old.frame.min_height, 406.26, 1e-9);
  EXPECT_NEAR(old.frame.max_height, 520.51, 1e-9);
  EXPECT_EQ(old.frame.horizontal_unit, "foot");
  options.points.classes = {2};
  EXPECT_EQ(read_points({shared("autzen_trim.las")}, options).source_points, 26'107U);
  const PointSet ground = read_points({shared("ign_lidarhd_0382_6565_crop.las")}, options);
  EXPECT_EQ(ground.source_points, 68'000U);
  EXPECT_TRUE(is_same_crs(ground.frame.crs_wkt, resolve_crs("EPSG:2154", "", "").wkt));
  EXPECT_THROW(std::ignore = read_points(
                   {shared("autzen_trim.las"), shared("ign_lidarhd_0382_6565_crop.las")}, {}),
               Error)
      << "two CRSs";
}

}  // namespace
}  // namespace ptin
