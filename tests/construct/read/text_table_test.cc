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

TEST(TextTable, EndsLinesInCrInLfAndInBoth) {
  const std::vector<Fields> rows = {{"1", "2"}, {"3", "4"}, {"5", "6"}};
  for (const char* text :
       {"1 2\r3 4\r5 6\r", "1 2\r3 4\r5 6", "1 2\r\n3 4\n5 6\r", "1 2\r3 4\r\n5 6",
        "\r\n\r1 2\n\r3 4\r\r\n5 6\r\r", "1 2\r\f3 4\r\n\f\n5 6\n\x1a"}) {
    EXPECT_EQ(contents_of(text).rows, rows) << text;
  }
  EXPECT_EQ(contents_of("x,y\r# remark\r1,2\r"), (Contents{{"x", "y"}, {{"1", "2"}}}));
  expect_text_refused("1 2\r3 4\r5\r", "text:3", "1 fields");
  expect_text_refused("1 2\r\n3 4\r\n5\r\n", "text:3", "1 fields");
}

/// A file that is read in pieces of a mebibyte, whose last byte is now the CR of a CR LF.
TEST(TextTable, FindsLineEndsThatLieAcrossPieces) {
  for (const char* end : {"\r", "\r\n"}) {
    for (std::size_t first = 1; first < 8; ++first) {
      std::string text = std::string(first, '1') + " 2" + end;
      while (text.size() < (std::size_t{1} << 20) + 64) text.append("3 4").append(end);
      std::istringstream in(text);
      TextTable table("text", in);
      std::size_t rows = 0;
      while (table.next()) ++rows;
      const std::size_t row = 3 + std::string(end).size();
      ASSERT_EQ(rows, 1 + (text.size() - first - 2 - std::string(end).size()) / row);
    }
  }
}

TEST(TextTable, TakesTheLastCommentThatNamesColumnsForTheHeader) {
  const auto header_of = [](const std::string& text) { return contents_of(text).header; };
  EXPECT_EQ(header_of("# lat lon ele\n1 2 3\n"), (Fields{"lat", "lon", "ele"}));
  EXPECT_EQ(header_of("# x y z\n#lat,lon,ele\n# written by hand\n1 2 3\n"),
            (Fields{"lat", "lon", "ele"}));
  EXPECT_EQ(header_of("//X Y Z R\n1 2 3 4\n"), (Fields{"X", "Y", "Z", "R"}));
  EXPECT_EQ(header_of("% northing;easting;height\n1;2;3\n"),
            (Fields{"northing", "easting", "height"}));
  EXPECT_EQ(header_of("! y x\n1 2 3\n"), (Fields{"y", "x", ""})) << "names are from the left";
  EXPECT_EQ(header_of("# Lat (deg) Lon (deg) Ele (m)\n1 2 3\n"),
            (Fields{"Lat (deg)", "Lon (deg)", "Ele (m)"}));
  EXPECT_EQ(header_of("# columns: y x z\n1 2 3\n"), (Fields{"y", "x", "z"}));
  EXPECT_EQ(header_of("# lat lon ele of the survey\n1 2 3\n"), (Fields{"lat", "lon", "ele"}));
  EXPECT_EQ(header_of("# x1 y1 h1 x2 y2 h2\n1 2 3 4 5 6\n").size(), 6U);
  for (const char* remark :
       {"# the y of x\n1 2 3\n", "# heights in metres\n1 2 3\n", "# Coordenadas x y z\n1 2 3\n",
        "# a x y z\n1 2 3\n", "1 2 3\n# y x z\n4 5 6\n", "#\n1 2 3\n"}) {
    EXPECT_EQ(header_of(remark), Fields{}) << remark;
  }
  EXPECT_EQ(header_of("# y x z\nx y z\n1 2 3\n"), (Fields{"x", "y", "z"})) << "a line is nearer";
}

TEST(TextTable, TellsTheEncodingThatItDoesNotRead) {
  using namespace std::string_literals;
  expect_text_refused("\xFF\xFE\1\0\n\0"s, "text:1", "this text is UTF-16");
  expect_text_refused("\xFE\xFF\0\1\0\n"s, "text:1", "this text is UTF-16");
  expect_text_refused("\xFF\xFE\0\0\1\0\0\0"s, "text:1", "this text is UTF-32");
  expect_text_refused("1\0 \0"s + "2\0\n\0"s, "text:1", "UTF-16LE");
  expect_text_refused("\0001\0 \0002\0\n"s, "text:1", "UTF-16BE");
  expect_text_refused("\n\0001\0 "s, "text:2", "UTF-16LE");
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

std::vector<Fields> points_in(const std::string& text, const std::vector<std::string>& columns) {
  TextTable table("text", text);
  TextRows rows(table, point_roles(), columns);
  std::vector<Fields> all;
  while (rows.next()) {
    all.push_back(
        {std::string(rows.field(0)), std::string(rows.field(1)), std::string(rows.field(2))});
  }
  return all;
}

TEST(TextRows, LetADescriptionHoldTheSeparator) {
  const std::vector<std::string> pnezd = {"p", "n", "e", "z", "d"};
  EXPECT_EQ(points_in("1,50,10,2.5,tree\n2,51,11,2.6,tree, old, oak\n", pnezd),
            (std::vector<Fields>{{"10", "50", "2.5"}, {"11", "51", "2.6"}}));
  EXPECT_EQ(points_in("x y z what\n1 2 3 oak\n4 5 6 old oak\n", {}),
            (std::vector<Fields>{{"1", "2", "3"}, {"4", "5", "6"}}));
  const auto expect_refused = [](const std::string& text, const std::vector<std::string>& columns) {
    EXPECT_THROW(static_cast<void>(points_in(text, columns)), Error) << text;
  };
  expect_refused("x,y,z,what\n1,2,3,oak\n1,5,2,5,3,oak\n", {});
  expect_refused("id,x,y,z\n1,2,3,4\n1,2,3,4,oak\n", {});
  expect_refused("1,2,3,oak\n1,2,3,old,oak\n", {});
  expect_refused("1,2,3,oak,5\n1,2,3,old,oak,7\n", {"x", "y", "z", "what"});
}

TEST(TextRows, TellTheUnitsOfTheirColumns) {
  const auto units_of = [](const std::string& text) {
    TextTable table("text", text);
    return TextRows(table, point_roles()).units();
  };
  EXPECT_EQ(units_of("x[m],y[m],z[ft]\n1,2,3\n"), (DeclaredUnits{"metre", "foot"}));
  EXPECT_EQ(units_of("x y z_ft\n1 2 3\n"), (DeclaredUnits{"", "foot"}));
  EXPECT_EQ(units_of("# Easting (usft) Northing (usft) z\n1 2 3\n"), (DeclaredUnits{"", ""}));
  EXPECT_EQ(units_of("E (US-ft),N (US-ft),H\n1,2,3\n"), (DeclaredUnits{"US survey foot", ""}));
  EXPECT_EQ(units_of("1 2 3\n"), DeclaredUnits());
  EXPECT_THROW(static_cast<void>(units_of("x_m y_ft z\n1 2 3\n")), Error);
}

TEST(ColumnNames, MayHaveAUnitBehindThem) {
  const std::vector<std::string> names = {"z_ft", "Lat (deg)", "lon[deg]", "z", "id_m"};
  EXPECT_EQ(find_column(names, {Coordinate::kZ}), 3U) << "a name without a unit is nearer";
  EXPECT_EQ(find_column(names, {Coordinate::kX}), 2U);
  EXPECT_EQ(find_column(names, {Coordinate::kY}), 1U);
  EXPECT_TRUE(is_coordinate_name("x [m]"));
  const std::vector<std::string> both = {"x", "y", "z_ft", "z"}, twins = {"x", "y", "z_ft", "z(m)"};
  EXPECT_EQ(columns_of(both, point_roles()), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_THROW(static_cast<void>(columns_of(twins, point_roles())), Error);
  EXPECT_FALSE(is_coordinate_name("point_m"));
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
