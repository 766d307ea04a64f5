// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points that were compressed are what they were, in every format; damaged files are refused.
#include "engine/construct/laz/compressed_records.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/laz/las_value.h"
#include "engine/error.h"
#include "tests/construct/laz/laz_file.h"
#include "tests/construct/laz/laz_points.h"
#include "tests/construct/laz/made_las.h"
#include "tests/support/las_file.h"

namespace ptin::laz {
namespace {

using oracle::las_bytes, oracle::made_las;

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

/// How the points of an uncompressed file begin, as far as they are read.
std::vector<unsigned char> beginnings(const std::string& las) {
  const auto bytes = las_bytes(las);
  const auto step = las_value<std::uint16_t>(bytes, 105);
  std::vector<unsigned char> all;
  for (std::size_t at = las_value<std::uint32_t>(bytes, 96); at < bytes.size(); at += step) {
    std::vector<unsigned char> p(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(at + kRecordBytes));
    if (bytes[104] >= 6) {
      std::fill(p.begin() + 12, p.begin() + 14, '\0');
      std::fill(p.begin() + 17, p.end(), '\0');
    }
    all.insert(all.end(), p.begin(), p.end());
  }
  return all;
}

std::string refusal_of(const std::string& file, ErrorCode code = ErrorCode::invalid_argument) {
  try {
    std::ignore = oracle::records_of(file);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    EXPECT_EQ(e.context(), "made.laz");
    return e.message();
  }
}

LazOptions options_for(int format) {
  LazOptions options;
  options.compressor = format < 6 ? 2 : 3;
  options.chunk_records = 700;
  return options;
}

TEST(CompressedRecords, AreWhatWasWrittenInEveryFormat) {
  for (int format = 0; format <= 10; ++format) {
    for (const int extra : {0, 5}) {
      SCOPED_TRACE(testing::Message() << format << " with " << extra);
      const std::string las = made_las(format, extra, 1500, 7);
      LazOptions options = options_for(format);
      options.bytes_of_others = format;
      EXPECT_EQ(oracle::records_of(laz_of(las, options)), beginnings(las));
    }
  }
}

TEST(CompressedRecords, AreOneChunkWithoutATable) {
  for (const int format : {0, 3, 5}) {
    const std::string las = made_las(format, 2, 5000, 1);
    LazOptions options;
    options.compressor = 1;
    EXPECT_EQ(oracle::records_of(laz_of(las, options)), beginnings(las));
  }
}

TEST(CompressedRecords, LieInChunksOfAnySizes) {
  for (const int format : {1, 6}) {
    const std::string las = made_las(format, 0, 5000, 3);
    LazOptions options = options_for(format);
    options.chunks = {1, 4500, 2, 1, 400, 96};
    for (const bool at_end : {false, true}) {
      options.table_place_at_end = at_end;
      EXPECT_EQ(oracle::records_of(laz_of(las, options)), beginnings(las));
    }
  }
}

TEST(CompressedRecords, MayBeNone) {
  for (const int format : {0, 6}) {
    EXPECT_TRUE(oracle::records_of(laz_of(made_las(format, 0, 0, 1), options_for(format))).empty());
  }
}

TEST(CompressedRecords, OfOneHeightAndClassHaveNoLayersOfThem) {
  LasFileMaker las;
  las.minor = 4;
  las.format = 6;
  for (int i = 0; i < 900; ++i) las.points.push_back({i * i, -i, 5, 65});
  LazOptions options = options_for(6);
  const std::string file = laz_of(las.bytes(), options);
  EXPECT_EQ(oracle::records_of(file), beginnings(las.bytes()));
  const auto chunk = las_value<std::uint32_t>(las_bytes(file), 96) + std::size_t{8};
  EXPECT_EQ(las_value<std::uint32_t>(las_bytes(file), chunk + 30 + 8), 0U);
}

TEST(CompressedRecords, OfAPartAreTheChunksThatBeginInIt) {
  const std::string las = made_las(3, 0, 100, 9);
  LazOptions options;
  for (const auto& chunks : {std::vector<std::uint32_t>{}, {1, 30, 1, 68}}) {
    options.chunk_records = 33;
    options.chunks = chunks;
    const std::string file = laz_of(las, options);
    const auto whole = oracle::records_of(file);
    for (std::uint64_t cut = 0; cut <= 101; ++cut) {
      auto both = oracle::records_of(file, 0, cut);
      const auto rest = oracle::records_of(file, cut, kAll);
      both.insert(both.end(), rest.begin(), rest.end());
      ASSERT_EQ(both, whole) << cut;
    }
  }
}

TEST(CompressedRecords, ThatAreCutAreRefused) {
  for (const int format : {3, 7}) {
    const std::string file = laz_of(made_las(format, 1, 900, 5), options_for(format));
    const auto first = las_value<std::uint32_t>(las_bytes(file), 96);
    for (std::size_t bytes = first; bytes < file.size(); bytes += 1 + bytes % 13) {
      ASSERT_NE(refusal_of(file.substr(0, bytes)), "") << bytes << " of " << file.size();
    }
  }
}

TEST(CompressedRecords, ThatAreDamagedAreRefusedOrAsManyAsTheHeaderSays) {
  for (const int format : {5, 10}) {
    const std::string good = laz_of(made_las(format, 1, 500, 5), options_for(format));
    const auto first = las_value<std::uint32_t>(las_bytes(good), 96);
    std::mt19937 random(4);
    int refused = 0;
    constexpr int kCases = 120;
    for (int i = 0; i < kCases; ++i) {
      std::string file = good;
      file[first + random() % (file.size() - first)] ^= static_cast<char>(1 + random() % 255);
      try {
        EXPECT_EQ(oracle::records_of(file).size(), 500 * kRecordBytes);
      } catch (const Error& e) {
        ++refused;
        ASSERT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
      }
    }
    EXPECT_GT(refused, kCases * (format < 6 ? 9 : 4) / 10);
  }
}

TEST(CompressedRecords, DoNotBelieveCountsThatLie) {
  for (const int format : {1, 6}) {
    LazOptions options = options_for(format);
    const std::string las = made_las(format, 0, 1000, 2);
    for (const bool varies : {false, true}) {
      options.chunks = varies ? std::vector<std::uint32_t>{300, 700} : std::vector<std::uint32_t>{};
      const std::string good = laz_of(las, options);
      const auto with_points = [&](std::uint64_t points) {
        std::string file = good;
        std::memcpy(file.data() + (format < 6 ? 107 : 247), &points, format < 6 ? 4 : 8);
        return refusal_of(file);
      };
      EXPECT_EQ(with_points(1000), "");
      EXPECT_NE(with_points(5000).find("says 5000 points and its chunks hold"), std::string::npos);
      EXPECT_NE(with_points(999).find("damaged"), std::string::npos);
      EXPECT_NE(with_points(1001).find(varies ? "its chunks hold 1000" : "damaged"),
                std::string::npos);
      CompressedPoints fewer = oracle::compressed_points_of(good);
      fewer.points = varies ? 300 : 700;
      const CompressedRecords read(fewer, 0, kAll);
      EXPECT_EQ(read.chunks_behind(), 1U);
      EXPECT_EQ(read.chunks(), 1U);
      EXPECT_EQ(CompressedRecords(oracle::compressed_points_of(good), 0, kAll).chunks(), 2U);
    }
  }
}

TEST(CompressedRecords, OfATableThatLiesAreRefused) {
  const std::string good = laz_of(made_las(1, 0, 1000, 2), options_for(1));
  const auto first = las_value<std::uint32_t>(las_bytes(good), 96);
  const auto table = las_value<std::uint64_t>(las_bytes(good), first);
  const auto with = [&](std::size_t at, auto value) {
    std::string file = good;
    std::memcpy(file.data() + at, &value, sizeof value);
    return refusal_of(file);
  };
  for (const std::int64_t place : {std::int64_t{0}, std::int64_t{first}, std::int64_t{-1},
                                   std::int64_t{-2}, std::int64_t{1} << 60}) {
    EXPECT_NE(with(first, place).find("table of chunks"), std::string::npos) << place;
  }
  EXPECT_NE(with(table, std::uint32_t{1}).find("version"), std::string::npos);
  EXPECT_NE(with(table + 4, std::uint32_t{1}).find("its chunks hold 700"), std::string::npos);
  EXPECT_NE(with(table + 4, std::uint32_t{0xffffffff}).find("more chunks than"), std::string::npos);
  EXPECT_NE(with(table + 8, std::uint32_t{0xffffffff}).find("table of chunks"), std::string::npos);
}

TEST(CompressedRecords, OfUnknownCompressorsAreRefused) {
  const std::string good = laz_of(made_las(1, 0, 10, 2), options_for(1));
  const std::size_t record = 235 + 54;
  const auto with = [&](std::size_t at, std::uint16_t value,
                        ErrorCode code = ErrorCode::unsupported_version) {
    std::string file = good;
    std::memcpy(file.data() + record + at, &value, sizeof value);
    return refusal_of(file, code);
  };
  EXPECT_NE(with(0, 4).find("compressor 4"), std::string::npos);
  EXPECT_NE(with(2, 1).find("coder 1"), std::string::npos);
  EXPECT_NE(with(34, 99).find("parts of kind 99"), std::string::npos);
  EXPECT_NE(with(38, 1).find("version 1 of parts of kind 6"), std::string::npos);
  const std::tuple<std::size_t, std::uint16_t, const char*> faults[] = {
      {0, 0, "names no compressor"},      {0, 3, "which its compressor has not"},
      {32, 1, "its parts make 20 bytes"}, {32, 3, "has not room for its 3 parts"},
      {34, 7, "a part of kind 7 of 20"},  {36, 21, "a part of kind 6 of 21"}};
  for (const auto& [at, value, told] : faults) {
    EXPECT_NE(with(at, value, ErrorCode::invalid_argument).find(told), std::string::npos) << told;
  }
  std::string wide = laz_of(made_las(0, 4080, 2, 2));
  EXPECT_NE(refusal_of(wide).find("more than 4096 bytes"), std::string::npos);
}

}  // namespace
}  // namespace ptin::laz
