// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text: `verify --against` takes every sample of a file by the rules by which it was built.
// One rule a case.
#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

/// `line(x, y, z)` over a hill of 9 x 9 points, under `header`.
template <typename LineOf>
std::string lines_of(const std::string& header, const LineOf& line) {
  std::string text = header;
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x)
      text += line(std::to_string(x), std::to_string(y), std::to_string(x * y % 7) + ".5") + "\n";
  }
  return text;
}

std::string x_y_z(const std::string& x, const std::string& y, const std::string& z) {
  return x + "," + y + "," + z;
}

class VerifyText : public ::testing::Test {
 protected:
  /// Builds `name` and verifies against it.
  void expect_sound(const std::string& name, const std::string& text) {
    write_file(folder_.file(name), text);
    build(name);
    const Outcome outcome = verified(name);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  }
  void build(const std::string& name) {
    const Outcome outcome =
        run_ptin({"build", folder_.file(name), "-o", folder_.file("p.ptin"), "--overwrite", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  Outcome verified(const std::string& name) {
    return run_ptin({"verify", folder_.file("p.ptin"), "--against", folder_.file(name), "-q"});
  }
  TestFolder folder_;
};

TEST_F(VerifyText, EndsLinesAsTheBuildDoes) {
  std::string text = lines_of("", x_y_z);
  for (char& c : text) c = c == '\n' ? '\r' : c;
  expect_sound("cr.csv", text);
  text[text.find('\r')] = '\n';
  text.insert(text.rfind("8,8"), "\n\f\r\n");
  expect_sound("mixed.csv", text + "\x1a");
}

TEST_F(VerifyText, TakesHeadersOfCommentsAndUnitsInNames) {
  const auto y_x_z = [](const std::string& x, const std::string& y, const std::string& z) {
    return y + " " + x + " " + z;
  };
  for (const char* header :
       {"# x y z\n# lat lon ele\n# by hand\n", "//Y X Z of the survey\n", "% columns: y x z\n",
        "y[m] x[m] z_ft\n", "Northing (m) Easting (m) Height (ft)\n", "# \"y\";\"x\";\"z\"\n"}) {
    expect_sound("header.txt", lines_of(header, y_x_z));
  }
  const auto with_words = [](const std::string& x, const std::string& y, const std::string& z) {
    return x_y_z(x, y, z) + ",tree" + (x == "3" ? ", old oak" : "");
  };
  expect_sound("description.csv", lines_of("x,y,z,what\n", with_words));
}

TEST_F(VerifyText, KnowsEveryNameThatAColumnMayHave) {
  const char* const names[][3] = {{"x", "y", "z"},
                                  {"easting", "northing", "height"},
                                  {"East", "North", "H"},
                                  {"e", "n", "elevation"},
                                  {"LONGITUDE", "LATITUDE", "elev"},
                                  {"lon", "lat", "altitude"},
                                  {"\"long\"", "y", "\" Alt\""}};
  for (const auto& name : names) {
    SCOPED_TRACE(name[0]);
    // Heights and places in another order than x, y, z; the first column has the look of one.
    const std::string header =
        std::string("id,").append(name[2]) + "," + name[1] + "," + name[0] + "\n";
    int id = 0;
    expect_sound("a.csv", lines_of(header, [&](const auto& x, const auto& y, const auto& z) {
                   return std::to_string(++id) + "," + z + "," + y + "," + x;
                 }));
  }
}

TEST_F(VerifyText, TakesTheFirstOfTwoNamesInTheOrderOfTheBuilder) {
  expect_sound("a.csv",
               lines_of("height,lon,x,y,z\n", [](const auto& x, const auto& y, const auto& z) {
                 return "1,2," + x_y_z(x, y, z);
               }));
}

TEST_F(VerifyText, CountsEmptyFields) {
  int number = 0;
  expect_sound("a.csv", lines_of("x,y,code,z\n", [&](const auto& x, const auto& y, const auto& z) {
                 return x + "," + y + (++number % 3 == 0 ? ",," : ",7,") + z;
               }));
}

TEST_F(VerifyText, HasOneSeparatorAFile) {
  expect_sound("a.csv",
               lines_of("point name,x,y,z\n", [](const auto& x, const auto& y, const auto& z) {
                 return "near the tree; or not," + x_y_z(x, y, z);
               }).replace(0, 0, "# one, two; three\n\n"));
  expect_sound("b.csv",
               lines_of("name, or so;x;y;z\n", [](const auto& x, const auto& y, const auto& z) {
                 return "a, b;" + x + "; " + y + " ;" + z + "\r";
               }));
  expect_sound("c.xyz", lines_of("", [](const auto& x, const auto& y, const auto& z) {
                 return "  " + x + "\t " + y + "  +" + z + " \r";
               }));
}

TEST_F(VerifyText, ReadsQuotesAndTabs) {
  expect_sound("a.csv",
               lines_of("\"a\nname\",x,y,z\n", [](const auto& x, const auto& y, const auto& z) {
                 return "\"An \"\"old\"\" tree,\n# with, three lines\n\" , \"" + x + "\"," + y +
                        ",\"" + z + "\" ";
               }));
  expect_sound("b.tsv", lines_of("id\tx\ty\tz\n", [](const auto& x, const auto& y, const auto& z) {
                 return "\t" + x + " \t" + y + "\t" + z + "\r";
               }));
  expect_sound("c.txt", lines_of("", [](const auto& x, const auto& y, const auto& z) {
                 return x + " " + y + " " + z + " \"big tree\" 5\"";
               }));
  expect_sound("d.csv", lines_of("x,y,z,2020\n", [](const auto& x, const auto& y, const auto& z) {
                 return x_y_z(x, y, z) + ",5\"";
               }));
}

TEST_F(VerifyText, PassesOverAByteOrderMark) {
  expect_sound("a.csv", lines_of("\xEF\xBB\xBFheight,x,y,z\n",
                                 [](const auto& x, const auto& y, const auto& z) {
                                   return "4," + x_y_z(x, y, z);
                                 }));
  expect_sound("b.csv", lines_of("\xEF\xBB\xBF", x_y_z));
}

TEST_F(VerifyText, UnpacksFilesOnTheWay) {
  const std::string text = lines_of("x,y,z\n", x_y_z);
  VSILFILE* file = VSIFOpenL(("/vsigzip/" + folder_.file("a.csv.gz")).c_str(), "wb");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(VSIFWriteL(text.data(), 1, text.size(), file), text.size());
  EXPECT_EQ(VSIFCloseL(file), 0);
  build("a.csv.gz");
  std::filesystem::copy_file(folder_.file("a.csv.gz"), folder_.file("B.CSV.GZ"));
  for (const char* name : {"a.csv.gz", "B.CSV.GZ"}) {
    const Outcome outcome = verified(name);
    EXPECT_EQ(outcome.status, 0) << name << outcome.out << outcome.err;
  }
  EXPECT_EQ(folder_.names().size(), 3U) << "nothing is left beside the sources";
}

TEST_F(VerifyText, TellsEachLineThatItDoesNotUnderstand) {
  const std::string text = lines_of("x,y,z\n", x_y_z);
  write_file(folder_.file("a.csv"), text);
  build("a.csv");
  write_file(folder_.file("b.csv"), text + "3,4\n3,four,5\n3,4,nan\n");
  const Outcome outcome = verified("b.csv");
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  for (const char* words :
       {"b.csv:83: there are 2 fields where the first line has 3",
        "b.csv:84: the y of this point, 'four'", "b.csv:85: the z of this point, 'nan', is NaN"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  }
}

TEST_F(VerifyText, RefusesAHeaderThatLacksAColumn) {
  write_file(folder_.file("a.csv"), lines_of("x,y,z\n", x_y_z));
  build("a.csv");
  write_file(folder_.file("b.csv"), lines_of("x,y,depth\n", x_y_z));
  const Outcome outcome = verified("b.csv");
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_NE(outcome.err.find("no column for z"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace ptin::tools
