// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/xyz_reader.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "tests/construct/memory_file.h"

namespace ptin {
namespace {

Decimal number(const std::string& text) {
  Decimal value;
  EXPECT_EQ(parse_number(text, value), NumberKind::kNumber) << text;
  return value;
}

NumberKind kind(const std::string& text) {
  Decimal value;
  return parse_number(text, value);
}

using Row = std::vector<double>;

std::vector<Row> rows_in(const std::string& text, const std::string& name = "points.xyz",
                         const std::vector<std::string>& columns = {}) {
  const MemoryFile file(name, text);
  XyzReader reader(file.path(), columns);
  std::vector<Row> rows;
  SourcePoint p;
  while (reader.next(p)) {
    rows.push_back({to_double(p.x), to_double(p.y), to_double(p.z)});
  }
  return rows;
}

void expect_line_refused(const std::string& text, const std::string& line,
                         const std::string& word) {
  try {
    rows_in(text);
    FAIL() << "accepted " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(e.context(), "/vsimem/points.xyz:" + line) << e.what();
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  }
}

TEST(ParseNumber, KeepsEveryDigitThatCounts) {
  EXPECT_EQ(number("0"), (Decimal{0, 0}));
  EXPECT_EQ(number("-12.50"), (Decimal{-125, 1}));
  EXPECT_EQ(number("+007"), (Decimal{7, 0}));
  EXPECT_EQ(number("636634.730"), (Decimal{63663473, 2}));
  EXPECT_EQ(number(".5"), (Decimal{5, 1}));
  EXPECT_EQ(number("5."), (Decimal{5, 0}));
  EXPECT_EQ(number("0.000000"), (Decimal{0, 0}));
  EXPECT_EQ(number("-0.0"), (Decimal{0, 0}));
  EXPECT_EQ(number("1.5e3"), (Decimal{1500, 0}));
  EXPECT_EQ(number("15E-4"), (Decimal{15, 4}));
  EXPECT_EQ(number("123456789012345678"), (Decimal{123456789012345678, 0}));
}

TEST(ParseNumber, RoundsDigitsBeyondTheEighteenth) {
  EXPECT_EQ(number("0.1234567890123456785"), (Decimal{123456789012345679, 18}));
  EXPECT_EQ(number("1e-30"), (Decimal{0, 0}));
  EXPECT_EQ(number("6e-19"), (Decimal{1, 18}));
  EXPECT_EQ(number("0.9999999999999999999999"), (Decimal{1, 0}));
  EXPECT_EQ(number("1.00000000000000000000000000000000001"), (Decimal{1, 0}));
}

TEST(ParseNumber, TellsWhatIsNoFiniteNumber) {
  EXPECT_EQ(kind("nan"), NumberKind::kNotANumber);
  EXPECT_EQ(kind("-NaN"), NumberKind::kNotANumber);
  EXPECT_EQ(kind("inf"), NumberKind::kInfinite);
  EXPECT_EQ(kind("-Infinity"), NumberKind::kInfinite);
  EXPECT_EQ(kind("1e18"), NumberKind::kTooLarge);
  EXPECT_EQ(kind("1234567890123456789"), NumberKind::kTooLarge);
  EXPECT_EQ(kind("99e66633333333332"), NumberKind::kTooLarge);
  EXPECT_EQ(kind("1e17"), NumberKind::kNumber);
  EXPECT_EQ(kind("1e999999999999"), NumberKind::kTooLarge);
  EXPECT_EQ(kind("999999999999999999.6"), NumberKind::kTooLarge) << "rounded, it is 10^18";
  EXPECT_EQ(kind("-999999999999999999.5"), NumberKind::kTooLarge);
  EXPECT_EQ(number("999999999999999999.4"), (Decimal{999999999999999999, 0}));
  EXPECT_EQ(number("99999999999999999.96"), (Decimal{100000000000000000, 0}));
  EXPECT_EQ(kind("na"), NumberKind::kNoNumber);
  EXPECT_EQ(kind("infinit"), NumberKind::kNoNumber);
  EXPECT_EQ(kind("infinityx"), NumberKind::kNoNumber);
  for (const char* text :
       {"", "-", ".", "x", "1x", "1e", "1e+", "1.2.3", "1 2", "--1", "0x10", "1,5"}) {
    EXPECT_EQ(kind(text), NumberKind::kNoNumber) << text;
  }
}

RC_GTEST_PROP(ParseNumber, AgreesWithTheLibrary, ()) {
  const auto mantissa = *rc::gen::arbitrary<std::int32_t>();
  const int decimals = *rc::gen::inRange(0, 12), exponent = *rc::gen::inRange(-5, 6);
  char text[64];
  std::snprintf(text, sizeof text, "%.*fe%d", decimals, mantissa / 1024.0, exponent);
  Decimal value;
  RC_ASSERT(parse_number(text, value) == NumberKind::kNumber);
  const double expected = std::strtod(text, nullptr);
  RC_ASSERT(std::abs(to_double(value) - expected) <= std::abs(expected) * 4.5e-16);
}

TEST(XyzReader, ReadsEverySeparator) {
  const std::vector<Row> expected{{1, 2, 3.5}, {-4, 5, 6}};
  EXPECT_EQ(rows_in("1 2 3.5\n-4 5 6\n"), expected);
  EXPECT_EQ(rows_in("1\t2\t3.5\n-4\t 5\t6"), expected);
  EXPECT_EQ(rows_in("1,2,3.5\n-4, 5 ,6\n"), expected);
  EXPECT_EQ(rows_in("1;2;3.5\r\n-4;5;6\r\n"), expected);
  EXPECT_EQ(rows_in("   1   2   3.5  \n  -4 5 6  \n"), expected);
}

TEST(XyzReader, PassesOverCommentsEmptyLinesAndFurtherColumns) {
  EXPECT_EQ(rows_in("# made by hand\n\n1 2 3 255 7\n  # more\n\r\n4 5 6 0 0\n\n"),
            (std::vector<Row>{{1, 2, 3}, {4, 5, 6}}));
}

TEST(XyzReader, FindsTheColumnsThatAHeaderNames) {
  const std::vector<Row> expected{{1, 2, 3}};
  EXPECT_EQ(rows_in("x,y,z\n1,2,3\n"), expected);
  EXPECT_EQ(rows_in("id;Height;Easting;Northing\n9;3;1;2\n"), expected);
  EXPECT_EQ(rows_in("\"LAT\",\"LON\",\"ELEVATION\"\n2,1,3\n"), expected);
  EXPECT_EQ(rows_in("name longitude latitude altitude\npeak 1 2 3\n"), expected);
  EXPECT_EQ(rows_in("\xEF\xBB\xBFX Y Z\n1 2 3\n"), expected);
}

TEST(XyzReader, TakesTheColumnsThatTheCallerNames) {
  const std::vector<Row> expected{{1, 2, 3}};
  EXPECT_EQ(rows_in("9,2,1,3,GND\n", "p.csv", {"id", "y", "x", "z", "code"}), expected);
  EXPECT_EQ(rows_in("P9,2,1,3,GND\n", "p.csv", {"P", "N", "E", "Z"}), expected)
      << "the rest has none";
  EXPECT_EQ(rows_in("id;a;b;c\n9;3;1;2\n", "p.csv", {"-", "h", "lon", "lat"}), expected);
  const auto refusal = [](const std::string& text, const std::vector<std::string>& columns) {
    try {
      rows_in(text, "p.csv", columns);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("1,2,3\n", {"id", "x", "y"}).find("no column for z"), std::string::npos);
  EXPECT_NE(refusal("1,2,3\n", {"x", "x", "y", "z"}).find("two columns for x"), std::string::npos);
  EXPECT_NE(refusal("1,2,3\n", {"x", "e", "y", "z"}).find("two columns for x"), std::string::npos);
  EXPECT_NE(refusal("1,2,3\n", {"x", "y", "z", "t"}).find("4 columns, and the first line has 3"),
            std::string::npos);
}

// It would be taken for x.
TEST(XyzReader, RefusesAFirstColumnThatNumbersTheRows) {
  const auto points = [](const std::string& header, const std::vector<int>& numbers,
                         const std::string& north) {
    std::string text = header;
    for (const int n : numbers) {
      text += std::to_string(n) + ",50" + std::to_string(n * n % 7) + north + ",22,9.5,GND\n";
    }
    return text;
  };
  expect_line_refused(points("", {1, 2, 3, 4}, ""), "4", "--columns id x y z");
  expect_line_refused(points("# a comment\n", {101, 102, 103}, ".25"), "4", "numbers the lines");
  expect_line_refused(points("", {1, 2, 5, 6, 9}, ".25"), "5", "none of them twice, the last as 9");
  EXPECT_EQ(rows_in(points("", {1, 2}, ".25")).size(), 2U) << "by chance";
  EXPECT_EQ(rows_in(points("", {1, 2, 3, 3}, ".25")).size(), 4U) << "a row of a grid";
  EXPECT_EQ(rows_in(points("", {1, 2, 5}, "")).size(), 3U) << "whole as its neighbours are";
  expect_line_refused(points("", {3, 1, 2, 17}, ".25"), "4", "the last as 17");
  expect_line_refused(points("", {9, 8, 7}, ".25"), "3", "the last as 7");
  expect_line_refused("1.0,5.5,2,3\n2.0,5.5,3,3\n3.0,6.5,2,3\n", "3", "one by one to 3");
  EXPECT_EQ(rows_in("1.5,5.5,2,3\n2.0,5.5,3,3\n3.0,6.5,2,3\n").size(), 3U);
  EXPECT_EQ(rows_in(points("x,y,z,w,code\n", {1, 2, 3}, ".25")).size(), 3U);
  EXPECT_EQ(rows_in(points("", {1, 2, 3}, ".25"), "p.csv", {"x", "y", "z"}).size(), 3U);
}

TEST(XyzReader, NamesUtf16) {
  using namespace std::string_literals;
  expect_line_refused(
      "\xFF\xFE"
      "1\0 \0"
      "2\0 \0"
      "3\0\n\0"s,
      "1", "UTF-16; save it as UTF-8");
  expect_line_refused(
      "\xFE\xFF\0"
      "1\0 \0"
      "2\0 \0"
      "3\0\n"s,
      "1", "UTF-16");
}

// Number, easting and northing of points without a height.
TEST(XyzReader, RefusesACountBesideDecimalsWhereNoColumnIsLeftOver) {
  expect_line_refused("1 2.5 3\n2 2.5 3\n3 2.5 4\n", "3", "--columns x y z if they are these");
  EXPECT_EQ(rows_in("1 2.5 3\n2 2.5 3\n3 2.5 4\n", "p.xyz", {"x", "y", "z"}).size(), 3U);
  EXPECT_EQ(rows_in("1 2 3\n2 2 3\n3 2 4\n").size(), 3U) << "whole as its neighbours are";
  EXPECT_EQ(rows_in("1 2.5 3\n3 2.5 3\n2 2.5 4\n").size(), 3U) << "not one by one";
}

TEST(XyzReader, RefusesAHeaderThatNamesACoordinateTwice) {
  expect_line_refused("x,y,X,z\n1,2,3,4\n", "1", "two columns 'x'");
  expect_line_refused("id,x,y,z,z\n1,2,3,4,5\n", "1", "--columns");
  EXPECT_EQ(rows_in("id,x,y,z,id\n1,2,3,4,5\n").size(), 1U) << "no coordinate";
  EXPECT_EQ(rows_in("lon,lat,x,y,z\n1,2,3,4,5\n").size(), 1U) << "x stands before lon";
}

TEST(XyzReader, FindsNoPointInAnEmptyFile) {
  EXPECT_TRUE(rows_in("").empty());
  EXPECT_TRUE(rows_in("\n# nothing\n").empty());
  EXPECT_TRUE(rows_in("x y z\n").empty());
}

TEST(XyzReader, NamesTheLineOfAFault) {
  expect_line_refused("1 2 3\n4 5\n", "2", "2 fields where the first line has 3");
  expect_line_refused("1 2 3\n\n#\n4 5 6 7\n", "4", "4 fields");
  expect_line_refused("1 2\n", "1", "x, y and z are expected");
  expect_line_refused("1 2 3\n1 nan 3\n", "2", "y of this point, 'nan', is NaN");
  expect_line_refused("nan 2 3\n", "1", "x of this point, 'nan', is NaN");
  expect_line_refused("1 2 3\n1 2 -inf\n", "2", "z of this point, '-inf', is infinite");
  expect_line_refused("1 2 3\n1 2 1e40\n", "2", "10^18");
  expect_line_refused("1 2 3\n1 2 high\n", "2", "'high'");
  expect_line_refused("1;2;3\n1,5;2,5;3,5\n", "2", "decimal comma; write it with a point, 1.5");
  expect_line_refused("1,2,3\n1,,3\n", "2", "is empty");
  expect_line_refused("a,1,2,3\n", "1", "the x of this point, 'a', is no number");
  expect_line_refused("a,1,2,3\n", "1", "as in --columns id x y z");
}

TEST(XyzReader, SaysWhichColumnAHeaderLacks) {
  expect_line_refused("x,y,depth\n1,2,3\n", "1", "names no column for z");
  expect_line_refused("Dear Sir, I write to you\n", "1", "taken for a header");
}

TEST(XyzReader, RefusesEndlessLines) {
  expect_line_refused("1 2 3\n" + std::string(100'000, '7'), "2", "64 KiB");
  expect_line_refused(std::string(3'000'000, '\0'), "1", "64 KiB");
}

TEST(XyzReader, ReadsLinesAcrossItsBuffer) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) {
    text += std::to_string(i) + " " + std::to_string(-i) + " 0.5\n";
  }
  const auto rows = rows_in(text);
  ASSERT_EQ(rows.size(), 200'000U);
  for (int i = 0; i < 200'000; ++i) {
    ASSERT_EQ(rows[static_cast<std::size_t>(i)], (Row{double(i), double(-i), 0.5}));
  }
}

TEST(XyzReader, SaysThatAFileDoesNotExist) {
  for (const char* path : {"/nowhere/points.xyz", "/nowhere/points.xyz.gz"}) {
    try {
      XyzReader reader(path);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::not_found) << e.what();
      EXPECT_EQ(e.context(), path);
    }
  }
}

TEST(XyzReader, UnpacksGzip) {
  for (const char* name : {"points.xyz.gz", "POINTS.XYZ.GZ", "points.csv.Gz"}) {
    EXPECT_EQ(rows_in(packed("1 2 3\n4 5 6\n"), name), (std::vector<Row>{{1, 2, 3}, {4, 5, 6}}))
        << name;
    EXPECT_TRUE(is_packed(name)) << name;
  }
  for (const char* name : {"points.xyz", "gz", "points.gz.csv", ""}) {
    EXPECT_FALSE(is_packed(name)) << name;
  }
}

TEST(XyzReader, ReportsPackedFilesThatAreDamagedOrCutShort) {
  std::string text;
  for (int i = 0; i < 5000; ++i) {
    text += std::to_string(i * 7919 % 100003) + " 2 3\n";
  }
  const std::string whole = packed(text);
  std::string damaged = whole;
  damaged[whole.size() / 2] = static_cast<char>(damaged[whole.size() / 2] ^ 0x55);
  for (const std::string& content :
       {whole.substr(0, whole.size() / 2), damaged, std::string("no gzip")}) {
    try {
      rows_in(content, "points.xyz.gz");
      FAIL() << "accepted";
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ErrorCode::io_error || e.code() == ErrorCode::invalid_argument)
          << e.what();
    }
  }
  try {
    rows_in("", "points.xyz.gz");
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
    EXPECT_NE(e.message().find("cut short"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace ptin
