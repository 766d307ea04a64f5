// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refusals of sources name what is at fault and a way out that works.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using testing::expect_refusal;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class SourceRefusals : public ::testing::Test {
 protected:
  Outcome build(const std::string& name, const std::string& content,
                const std::vector<std::string>& more = {}) {
    write_file(folder_.file(name), content);
    std::vector<std::string> all = {"build", folder_.file(name), "-o", folder_.file("t.ptin"),
                                    "-q",    "--overwrite"};
    all.insert(all.end(), more.begin(), more.end());
    return run_ptin(all);
  }
  TestFolder folder_;
};

TEST_F(SourceRefusals, NameTheSeparatorThatOneLineHasAndAnotherHasNot) {
  const std::string text = "\"X\",\"Y\",\"Z\"\n0 1 2\n15 1 2\n";
  expect_refusal(build("a.txt", text), 2, "commas separate the fields of the first line");
  expect_refusal(build("a.txt", text, {"--columns", "x", "y", "z"}), 2,
                 "commas separate the fields of the first line");
  expect_refusal(build("a.txt", "x;y;z\n0 1 2\n"), 2, "semicolons separate");
}

TEST_F(SourceRefusals, NameBarsThatSeparateNothing) {
  const std::string text = "id|description|x|z|y\n1|Inside|15|35|3\n2|Outside 1|5|35|3\n";
  expect_refusal(build("a.txt", text), 2, "'|' is no separator");
  expect_refusal(build("a.txt", text, {"--columns", "id", "what", "x", "z", "y"}), 2,
                 "'|' is no separator");
  expect_refusal(build("a.txt", "1|2|3\n4|5|6\n"), 2, "'|' is no separator");
}

TEST_F(SourceRefusals, PassOverTheLineThatTellsExcelTheSeparator) {
  EXPECT_EQ(build("a.csv", "sep=;\nx;y;z\n0;0;1\n9;0;2\n9;9;3\n").status, 0);
  const Outcome sound =
      run_ptin({"verify", folder_.file("t.ptin"), "--against", folder_.file("a.csv"), "-q"});
  EXPECT_EQ(sound.status, 0) << sound.err << sound.out;
}

TEST_F(SourceRefusals, SayWhatToDoWithoutAHeight) {
  expect_refusal(build("a.csv", "x,y,z\n0,0,1\n9,0,\n9,9,3\n"), 2, "leave the line out");
  expect_refusal(build("a.geojson", R"({"type":"FeatureCollection","features":[{"type":"Feature",)"
                                    R"("properties":{"name":"a"},"geometry":{"type":"Point",)"
                                    R"("coordinates":[1,2]}}]})"),
                 2, "no attribute holds numbers");
  expect_refusal(
      build("b.geojson",
            R"({"type":"FeatureCollection","features":[{"type":"Feature",)"
            R"("properties":{"h":7},"geometry":{"type":"Point","coordinates":[1,2]}}]})"),
      2, "--z-field");
}

TEST_F(SourceRefusals, TellHowARasterInXmlIsNamed) {
  expect_refusal(build("a.xml", "<Product_Observational/>"), 2, "PDS4:FILE.xml:1:1");
}

TEST_F(SourceRefusals, TellPlacesWithAllTheirDigits) {
  expect_refusal(build("a.obj",
                       "v 429877111.59 0 1\nv 429877119.59 0 1\nv 429877119.59 9 1\n"
                       "v 429877111.59 0 2\nf 1 2 3\nf 4 2 3\n"),
                 2, "429877111.59");
}

TEST_F(SourceRefusals, TakeWhatCommentsSayMeansNoHeight) {
  EXPECT_EQ(build("a.xyz", "# nodata -9999\n0 0 1\n9 0 2\n9 9 3\n5 5 -9999\n").status, 0);
  const Outcome sound =
      run_ptin({"verify", folder_.file("t.ptin"), "--against", folder_.file("a.xyz"), "-q"});
  EXPECT_EQ(sound.status, 0) << sound.err << sound.out;
}

}  // namespace
}  // namespace ptin::tools
