// SPDX-License-Identifier: GPL-3.0-or-later
//
// Breaklines and a boundary on the command line: built, and held against their files.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

std::string csv(const std::vector<std::string>& shapes) {
  std::string text = "id,WKT\n";
  for (const std::string& shape : shapes) {
    text += "1,\"" + shape + "\"\n";
  }
  return text;
}

class VerifyLines : public ::testing::Test {
 protected:
  VerifyLines() {
    std::string text;
    for (int y = 0; y <= 40; ++y) {
      for (int x = 0; x <= 40; ++x) {
        const double z = 50 + 8 * std::sin(0.4 * x) * std::cos(0.3 * y);
        text += std::to_string(x * 10 + (y * 7 % 5)) + "," + std::to_string(y * 10 + (x * 3 % 4)) +
                "," + std::to_string(std::lround(z)) + "\n";
      }
    }
    write_file(points(), text);
    write_file(lines(), csv({"LINESTRING Z (20.25 30.5 90,380.75 310.5 70.25)",
                             "LINESTRING Z (15 360 20,350 20 120.125)",  // other heights: a ditch
                             "LINESTRING Z (200 60 40,200 110 40,260 110 40,200 60 40)"}));
    write_file(area(), csv({"POLYGON Z ((5 5 60,395 15 60,390 395 60,210 330 60,8 390 60,5 5 60),"
                            "(300 60 50,350 65 50,320 100 50,300 60 50))"}));
  }
  [[nodiscard]] std::string points() const { return folder_.file("points.csv"); }
  [[nodiscard]] std::string lines() const { return folder_.file("lines.csv"); }
  [[nodiscard]] std::string area() const { return folder_.file("area.csv"); }
  [[nodiscard]] std::string terrain() const { return folder_.file("t.ptin"); }
  Outcome build(std::vector<std::string> more) {
    std::vector<std::string> all = {"build",       points(), "-o", terrain(),
                                    "--overwrite", "--tile", "10"};
    all.insert(all.end(), more.begin(), more.end());
    return run_ptin(all);
  }
  Outcome verify(std::vector<std::string> more) {
    std::vector<std::string> all = {"verify", terrain(), "--against", points(), "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return run_ptin(all);
  }
  TestFolder folder_;
};

TEST_F(VerifyLines, RefusesCrossingsOfTwoHeightsAndNamesThePlace) {
  const Outcome refused = build({"--breaklines", lines()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("with two heights"), std::string::npos) << refused.err;
}

TEST_F(VerifyLines, FindsEveryLineWithinTheErrors) {
  write_file(lines(), csv({"LINESTRING Z (20.25 30.5 90,380.75 310.5 70.25)",
                           "LINESTRING Z (20.25 250 84,150.125 20 85.93)",  // crosses at its height
                           "LINESTRING Z (200 60 40,200 110 40,260 110 40,200 60 40)"}));
  for (const bool with_area : test::some_of({false, true})) {
    SCOPED_TRACE(with_area);
    std::vector<std::string> options = {"--breaklines", lines()};
    if (with_area) {
      options.insert(options.end(), {"--boundary", area()});
    }
    const Outcome built = build(options);
    ASSERT_EQ(built.status, 0) << built.err;
    EXPECT_NE(built.out.find("--breaklines " + lines()), std::string::npos);  // in what is next
    const Outcome verified = verify(options);
    EXPECT_EQ(verified.status, 0) << verified.out;
    EXPECT_NE(verified.out.find("worst_breakline_error"), std::string::npos);
    EXPECT_EQ(verify({}).status, 2);
    EXPECT_EQ(verify({"--breaklines", lines(), lines()}).status, 2);
    // The same files with one vertex raised are not those of the build.
    write_file(folder_.file("other.csv"),
               csv({"LINESTRING Z (20.25 30.5 90,380.75 310.5 75.25)",
                    "LINESTRING Z (20.25 250 84,150.125 20 85.93)",
                    "LINESTRING Z (200 60 40,200 110 40,260 110 40,200 60 40)"}));
    options[1] = folder_.file("other.csv");
    const Outcome other = verify(options);
    EXPECT_EQ(other.status, 1) << other.out << other.err;
    EXPECT_NE(other.out.find("the breakline at"), std::string::npos) << other.out;
  }
}

TEST_F(VerifyLines, HoldsPointsAgainstABoundaryWithoutHeights) {
  write_file(lines(), csv({"LINESTRING Z (20.25 30.5 90,380.75 310.5 70.25)"}));
  write_file(area(), csv({"POLYGON ((50 -20,450 100,395 385.5,210 330,-8 300,50 -20),"
                          "(250 60,350 65,320 130,250 60))"}));
  const std::vector<std::string> options = {"--breaklines", lines(), "--boundary", area()};
  const Outcome built = build(options);
  ASSERT_EQ(built.status, 0) << built.err;
  const Outcome verified = verify(options);
  EXPECT_EQ(verified.status, 0) << verified.out;
  // Another boundary leaves out points that the terrain has.
  write_file(folder_.file("other.csv"), csv({"POLYGON ((50 -20,450 100,210 330,-8 300,50 -20))"}));
  const Outcome other = verify({"--breaklines", lines(), "--boundary", folder_.file("other.csv")});
  EXPECT_EQ(other.status, 1) << other.out << other.err;
}

TEST_F(VerifyLines, LeavesOutWhatABoxLeftOutBesideLongerLines) {
  write_file(lines(), csv({"LINESTRING Z (20.25 30.5 90,380.75 310.5 70.25)"}));
  ASSERT_EQ(build({"--breaklines", lines(), "--bbox", "100", "100", "250", "220"}).status, 0);
  const Outcome verified = verify({"--breaklines", lines()});
  EXPECT_EQ(verified.status, 0) << verified.out;
}

/// At the crossing both lines are at 259.01501, half a step of the heights, on a grid of thousandths.
TEST_F(VerifyLines, AgreesOnCrossingsAtHalfAStep) {
  write_file(points(),
             "x,y,z\n256.460,742.881,25.95\n-0.004,-0.004,39.88\n"
             "1009.996,-0.004,8.50\n-0.004,1009.996,34.68\n");
  write_file(lines(), csv({"LINESTRING Z (330 277 234.25,259 552 267.5)",
                           "LINESTRING Z (178 615 242.75,405 310 280)"}));
  ASSERT_EQ(build({"--breaklines", lines()}).status, 0);
  const Outcome verified = verify({"--breaklines", lines()});
  EXPECT_EQ(verified.status, 0) << verified.out;
}

/// A resolution counts from 0 in doubles, in which 108.35 is 1083 steps of 0.1 and no more.
TEST_F(VerifyLines, AgreesOnVerticesBetweenTwoStepsOfAResolution) {
  write_file(lines(), csv({"LINESTRING Z (51.35 52.25 9,108.35 96.55 4)"}));
  for (const char* resolution : {"0.1", "0.5"}) {
    ASSERT_EQ(build({"--breaklines", lines(), "--resolution", resolution}).status, 0);
    const Outcome verified = verify({"--breaklines", lines()});
    EXPECT_EQ(verified.status, 0) << verified.out;
  }
}

TEST_F(VerifyLines, IsForPoints) {
  write_file(folder_.file("mesh.obj"), "v 0 0 1\nv 9 0 1\nv 0 9 1\nf 1 2 3\n");
  const Outcome tin =
      run_ptin({"build", folder_.file("mesh.obj"), "-o", terrain(), "--breaklines", lines()});
  EXPECT_EQ(tin.status, 2);
  EXPECT_NE(tin.err.find("--breaklines is for points"), std::string::npos) << tin.err;
  const Outcome swallowed = run_ptin({"build", "-o", terrain(), "--breaklines", lines(), points()});
  EXPECT_EQ(swallowed.status, 2);
  EXPECT_NE(swallowed.err.find("put INPUT before it"), std::string::npos) << swallowed.err;
}

TEST_F(VerifyLines, RefusesLinesElsewhere) {
  write_file(lines(), csv({"LINESTRING Z (5000 5000 1,6000 5000 1)"}));
  const Outcome refused = build({"--breaklines", lines()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("lies where the points do"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace ptin::tools
