// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/text_table.h"

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/read/text_rows.h"
#include "engine/error.h"

namespace ptin {
namespace {

using Fields = std::vector<std::string>;

struct Contents {
  Fields header;
  std::vector<Fields> rows;
  bool operator==(const Contents&) const = default;
};

Contents contents_of(const std::string& text) {
  TextTable table("text", text);
  Contents all{table.header(), {}};
  while (table.next()) {
    all.rows.emplace_back(table.fields().begin(), table.fields().end());
  }
  return all;
}

void expect_text_refused(const std::string& text, const std::string& place,
                         const std::string& words) {
  try {
    contents_of(text);
    FAIL() << "accepted " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(e.context(), place) << e.what();
    EXPECT_NE(e.message().find(words), std::string::npos) << e.what();
  }
}

TEST(TextTable, IsSeparatedAsItsFirstLineIs) {
  EXPECT_EQ(contents_of("1;2,5\n3 ; 4\n").rows, (std::vector<Fields>{{"1", "2,5"}, {"3", "4"}}));
  EXPECT_EQ(contents_of("1,2\t5\n3 4,\n").rows, (std::vector<Fields>{{"1", "2\t5"}, {"3 4", ""}}));
  EXPECT_EQ(contents_of("1\tHigh Rock \n\t\n2\t\r\n").rows,
            (std::vector<Fields>{{"1", "High Rock"}, {"2", ""}}));
  EXPECT_EQ(contents_of("  1   2\n3\t4 \r\n").rows, (std::vector<Fields>{{"1", "2"}, {"3", "4"}}));
  EXPECT_EQ(contents_of(" 1\t 2  +3\r\n4 5 6\n").rows,
            (std::vector<Fields>{{"1", "2", "+3"}, {"4", "5", "6"}}));
  EXPECT_EQ(contents_of("Route 66\t7 \n\t8\n").rows,
            (std::vector<Fields>{{"Route 66", "7"}, {"", "8"}}));
  expect_text_refused("1;2\n3,4\n", "text:2", "1 fields where the first line has 2");
  expect_text_refused("a,b\n7,25,43,75\n", "text:2", "numbers have a decimal point");
}

TEST(TextTable, HasAHeaderWhereNothingBeginsAsANumber) {
  EXPECT_EQ(contents_of("id,place\n1,2\n"), (Contents{{"id", "place"}, {{"1", "2"}}}));
  EXPECT_EQ(contents_of("x,y,2020\n1,2,3\n"), (Contents{{"x", "y", "2020"}, {{"1", "2", "3"}}}))
      << "it names x and y";
  EXPECT_EQ(contents_of("A,1,2\n"), (Contents{{}, {{"A", "1", "2"}}}));
  EXPECT_EQ(contents_of("7m 3m\n"), (Contents{{}, {{"7m", "3m"}}}));
  EXPECT_EQ(contents_of("nan,nan\n").header, Fields{});
  EXPECT_EQ(contents_of("\" x \",\"y\"\n"), (Contents{{"x", "y"}, {}}));
}

TEST(TextTable, ReadsFieldsInQuotes) {
  EXPECT_EQ(contents_of("1,\"A, b\",86.9\n2, \"say \"\"B\"\"\" ,\"\"\n").rows,
            (std::vector<Fields>{{"1", "A, b", "86.9"}, {"2", "say \"B\"", ""}}));
  EXPECT_EQ(contents_of("\"a;b\" 1 \"c d\"\n").rows, (std::vector<Fields>{{"a;b", "1", "c d"}}));
  EXPECT_EQ(contents_of("1,5\" pipe\n").rows, (std::vector<Fields>{{"1", "5\" pipe"}}))
      << "no field is quoted";
  EXPECT_EQ(contents_of("1,\"two\r\nlines, and\n\n# a third\",2\n3,4,5\n").rows,
            (std::vector<Fields>{{"1", "two\r\nlines, and\n\n# a third", "2"}, {"3", "4", "5"}}));
  EXPECT_EQ(contents_of("\"first\nline\";x;y\n\"#1\";2;3\n"),
            (Contents{{"first\nline", "x", "y"}, {{"#1", "2", "3"}}}));
  expect_text_refused("1,2\n\"a\"b,3\n", "text:2", "text follows the quotes around field 1");
  expect_text_refused("1,2\n3,\"a\n5,6\n", "text:2", "does not end");
  expect_text_refused("1,2\n3,\"a" + std::string(70'000, '\n'), "text:2", "within 64 KiB");
}

TEST(TextTable, TellsTheLineThatARowBeginsIn) {
  TextTable table("text", "\xEF\xBB\xBF# mark\n1,\"a\nb\"\n2,c\n");
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.line(), 2U);
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.line(), 4U);
  EXPECT_FALSE(table.next());
  EXPECT_EQ(table.bytes_read(), 22U);
}

TEST(TextTable, ReadsAStreamToItsEnd) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += std::to_string(i) + ";\"q" + std::to_string(i) + "\"\n";
  std::istringstream in(text);
  TextTable table("standard input", in);
  int rows = 0;
  for (; table.next(); ++rows) {
    ASSERT_EQ(table.fields()[1], "q" + std::to_string(rows));
  }
  EXPECT_EQ(rows, 200'000);
}

Fields ids_in(const std::string& text, const std::string& id,
              const std::vector<std::string>& columns) {
  constexpr std::array<ColumnRole, 2> kXY = {{{Coordinate::kX}, {Coordinate::kY}}};
  TextTable table("text", text);
  TextRows rows(table, kXY, columns);
  Fields all;
  if (!rows.choose_id(id)) return all;
  while (rows.next()) {
    all.push_back(std::string(rows.id()).append("@").append(rows.field(0)));
  }
  return all;
}

TEST(TextRows, TakesTheFirstColumnThatIsNoCoordinateForAnId) {
  EXPECT_EQ(ids_in("x,y,z,name,code\n1,2,3,a,b\n", "", {}), Fields{"a@1"});
  EXPECT_EQ(ids_in("x,y,z,name,code\n1,2,3,a,b\n", "CODE", {}), Fields{"b@1"});
  EXPECT_EQ(ids_in("x,y,z,name,code\n1,2,3,a,b\n", "z", {}), Fields{"3@1"});
  EXPECT_EQ(ids_in("7 1 2\n", "", {"id", "x", "y"}), Fields{"7@1"});
  EXPECT_EQ(ids_in("x,y,z\n1,2,3\n", "", {}), Fields{});
  EXPECT_EQ(ids_in("1,2,3\n", "", {}), Fields{});
  for (const char* text : {"x,y,z\n1,2,3\n", "1,2,3\n"}) {
    EXPECT_THROW(static_cast<void>(ids_in(text, "name", {})), Error) << text;
  }
}

TEST(ColumnNames, KnowTheTwoEndsOfALine) {
  const std::vector<std::string> names = {"Lat_2", "LON_2", "x1", "y1", "h1", "z 2"};
  EXPECT_EQ(find_column(names, {Coordinate::kX, 1}), 2U);
  EXPECT_EQ(find_column(names, {Coordinate::kX, 2}), 1U);
  EXPECT_EQ(find_column(names, {Coordinate::kY, 2}), 0U);
  EXPECT_EQ(find_column(names, {Coordinate::kZ, 2}), 5U);
  EXPECT_EQ(find_column(names, {Coordinate::kX}), names.size());
  EXPECT_TRUE(is_coordinate_name("Point_Y2"));
  EXPECT_FALSE(is_coordinate_name("id"));
  EXPECT_FALSE(is_coordinate_name("2"));
}

}  // namespace
}  // namespace ptin
