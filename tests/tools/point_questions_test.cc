// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin locate, profile and sight, end to end.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/wall_terrain.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::east;
using testing::lines_in;
using testing::Outcome;
using testing::run_ptin;
using testing::south;
using testing::TestFolder;
using testing::wall;
using testing::write_file;

TEST(LocateCommand, TellsThreeStatesApart) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const json top = answer_of({"locate", terrain, east(16), south(10), "--json"}).at("points").at(0);
  EXPECT_EQ(top.at("state"), "surface");
  EXPECT_EQ(top.at("height"), 100.0);
  EXPECT_EQ(top.at("height_min"), top.at("height_max"));
  EXPECT_EQ(top.at("triangle").size(), 3u);
  const json hole = answer_of({"locate", terrain, east(31), south(1), "--json"}).at("points").at(0);
  EXPECT_EQ(hole.at("state"), "void");
  EXPECT_TRUE(hole.at("height").is_null());
  const json off = answer_of({"locate", terrain, "0", "0", "--json"}).at("points").at(0);
  EXPECT_EQ(off.at("state"), "outside");
}

TEST(LocateCommand, ReadsLinesThatEndInCrUnderAComment) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string first = east(15.5) + " " + south(20), second = east(3) + " " + south(3);
  write_file(folder.file("p.txt"), first + "\n" + second + "\n0 0\n");
  write_file(folder.file("cr.txt"), first + "\r" + second + "\r\n0 0");
  write_file(folder.file("comment.txt"), "# northing easting\r" + south(20) + " " + east(15.5) +
                                             "\r" + south(3) + " " + east(3) + "\r0 0\r");
  const Outcome usual = run_ptin({"locate", terrain, "--points", folder.file("p.txt")});
  EXPECT_EQ(lines_in(usual.out), 4u);
  for (const char* name : {"cr.txt", "comment.txt"}) {
    EXPECT_EQ(run_ptin({"locate", terrain, "--points", folder.file(name)}).out, usual.out) << name;
  }
}

TEST(LocateCommand, ReadsManyPointsAndKeepsTheirOrder) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  write_file(folder.file("p.csv"),
             "x,y\n" + east(15.5) + "," + south(20) + "\n0, 0\n" + east(3) + "," + south(3) + "\n");
  const Outcome outcome = run_ptin({"locate", terrain, "--points", folder.file("p.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(lines_in(outcome.out), 4u);
  EXPECT_NE(outcome.out.find("surface,55,55,55"), std::string::npos) << outcome.out;
  EXPECT_LT(outcome.out.find("surface,55"), outcome.out.find("outside"));
  EXPECT_LT(outcome.out.find("outside"), outcome.out.find("surface,10,10,10"));
}

TEST(LocateCommand, TakesTheColumnsThatTheHeaderNames) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string points = folder.file("p.csv");
  const auto located = [&](const std::string& text) {
    write_file(points, text);
    return run_ptin({"locate", terrain, "--points", points});
  };
  const std::string x = east(15.5), y = south(20);
  for (const std::string& text :
       {"y,x\n" + y + "," + x + "\n", "id;\"Easting\";name; NORTHING\n7;" + x + ";a;" + y + "\n",
        "lat lon\r\n" + y + " " + x + "\r\n", "POINT_Y,POINT_X\n" + y + "," + x + "\n"}) {
    const Outcome outcome = located(text);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("surface,55,55,55"), std::string::npos) << text << outcome.out;
  }
  const Outcome half = located("id,y\n1,2\n");
  EXPECT_EQ(half.status, 2);
  EXPECT_NE(half.err.find("for x"), std::string::npos) << half.err;
  EXPECT_EQ(located("id,y,x\n1,2\n").status, 2) << "a field is missing";
}

/// On the corner of a void: ground touches the line there, though it runs from outside into the
/// void.
TEST(ProfileCommand, TellsTheHeightWhereGroundTouchesTheLine) {
  const TestFolder folder;
  write_file(folder.file("a.asc"),
             "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9\n"
             "1 2 3\n4 -9 6\n7 8 9\n");
  const Outcome made = run_ptin({"build", folder.file("a.asc"), "-o", folder.file("a.ptin"), "-q"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Outcome outcome =
      run_ptin({"profile", folder.file("a.ptin"), "--line", "LINESTRING(0 15, 30 15)"});
  EXPECT_NE(
      outcome.out.find("\n5,5,15,4,void,0,4,4\n15,15,15,,void,0,,\n25,25,15,6,outside,0,6,6\n"),
      std::string::npos)
      << outcome.out;
}

TEST(ProfileCommand, MeasuresDegreesOnTheEllipsoid) {
  const TestFolder folder;
  const std::string terrain = testing::built(folder, "coast_257.tif");
  const json answer =
      answer_of({"profile", terrain, "--line", "LINESTRING(-124.25 48.46,-124.2 48.46)", "--json"});
  // 0.05 degrees of the parallel at 48.46 N of GRS 80: N cos(lat) = 4239.5 km; a geodesic is a
  // little shorter.
  EXPECT_NEAR(answer.at("length").get<double>(), 3697.9, 2.0);
  EXPECT_EQ(answer.at("units").at("length"), "metre");
  const json sight = answer_of(
      {"sight", terrain, "-124.25", "48.46", "5000", "-124.2", "48.46", "5000", "--json"});
  EXPECT_NEAR(sight.at("length").get<double>(), answer.at("length").get<double>(), 1e-6);
}

TEST(LocateCommand, NamesTheLineThatIsNoPoint) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  write_file(folder.file("p.csv"), "x,y\n1,2\nhere\n");
  const Outcome outcome = run_ptin({"locate", terrain, "--points", folder.file("p.csv")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("p.csv:3: "), std::string::npos) << outcome.err;
  EXPECT_EQ(run_ptin({"locate", terrain}).status, 2);
  EXPECT_EQ(run_ptin({"locate", terrain, "--points", folder.file("none.csv")}).status, 3);
}

TEST(LocateCommand, LosesNoFirstRow) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string points = folder.file("p.csv");
  const std::string row = east(3) + "," + south(3);
  const auto count = [&](const std::string& text) {
    write_file(points, text);
    return answer_of({"locate", terrain, "--points", points, "--json"}).at("points").size();
  };
  EXPECT_EQ(count("\xEF\xBB\xBF" + row + "\r\n" + row + "\r\n"), 2u);
  EXPECT_EQ(count("\xEF\xBB\xBFx,y\n" + row + "\n"), 1u);
  EXPECT_EQ(count("\n  " + east(3) + " , \t" + south(3) + " ,,,name\n" + row + ",,,\n"), 2u);
  EXPECT_EQ(count(east(3) + "   " + south(3) + "\n\n" + east(3) + "\t" + south(3)), 2u);
  for (const char* first : {"380000m 3802000m", "here,380000,3802000"}) {
    write_file(points, first + ("\n" + row + "\n"));
    const Outcome outcome = run_ptin({"locate", terrain, "--points", points});
    EXPECT_EQ(outcome.status, 2) << first;
    EXPECT_NE(outcome.err.find("p.csv:1: "), std::string::npos) << outcome.err;
  }
}

TEST(LocateCommand, ShiftsNoColumnWhereANumberIsMissing) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string points = folder.file("p.csv");
  for (const char* bad : {"380000,,3802000", ",380000,3802000", "380000; ;3802000", "380000,",
                          "380000\t\t3802000", ",,"}) {
    write_file(points, "x,y\n1,2\n" + std::string(bad) + "\n");
    const Outcome outcome = run_ptin({"locate", terrain, "--points", points});
    EXPECT_EQ(outcome.status, 2) << bad;
    EXPECT_NE(outcome.err.find("p.csv:3: "), std::string::npos) << outcome.err;
  }
}

// Where each line has separators of its own, a comma is what anybody takes it for.
TEST(PointQuestions, KeepToTheSeparatorOfTheFirstLine) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const auto refused = [&](const char* command, const char* option, const std::string& text) {
    write_file(folder.file("p.csv"), text);
    const Outcome outcome = run_ptin({command, terrain, option, folder.file("p.csv")});
    EXPECT_EQ(outcome.status, 2) << text;
    EXPECT_EQ(outcome.out, "") << text;
    EXPECT_EQ(lines_in(outcome.err), 1u) << outcome.err;
    return outcome.err;
  };
  const auto expect_comma_named = [](const std::string& message, const std::string& place) {
    EXPECT_NE(message.find(place), std::string::npos) << message;
    EXPECT_NE(message.find("decimal comma; write it with a point, 7.25"), std::string::npos)
        << message;
  };
  expect_comma_named(refused("locate", "--points", "7,25;43,75\n"), "p.csv:1: ");
  expect_comma_named(refused("locate", "--points", "x;y\n1;2\n7,25;43,75\n"), "p.csv:3: ");
  expect_comma_named(refused("locate", "--points", "x y\n7,25 43,75\n"), "p.csv:2: ");
  expect_comma_named(refused("sight", "--pairs", "7,25;43,75;2;9;4;2\n"), "p.csv:1: ");
  EXPECT_NE(refused("locate", "--points", "7,25 43,75\n").find("'25 43', holds two numbers"),
            std::string::npos);
  EXPECT_NE(refused("sight", "--pairs", "1 2 3 4 5 6\n1 2 3 4 5,5 6 7\n").find("7 fields"),
            std::string::npos);
  EXPECT_NE(refused("locate", "--points", "x,y\n7,25,43,75\n").find("4 fields where"),
            std::string::npos);
  EXPECT_NE(refused("locate", "--points", "1;2\n3,4\n").find("p.csv:2: "), std::string::npos);
  EXPECT_NE(refused("locate", "--points", "1 2\nnan 2\n").find("'nan', is not finite"),
            std::string::npos);
}

TEST(PointQuestions, TakeTheColumnsThatAreNamed) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string points = folder.file("p.txt");
  std::string rows;
  for (int i = 1; i < 5; ++i) {
    rows += std::to_string(i) + ",\"A, b\"," + south(20) + "," + east(15.5) + "\n";
  }
  write_file(points, rows);
  const Outcome named =
      run_ptin({"locate", terrain, "--points", points, "--columns", "n", "name", "y", "x"});
  EXPECT_EQ(named.status, 2) << "n is a northing, and so is y";
  EXPECT_NE(named.err.find("two columns for y"), std::string::npos) << named.err;
  const json answer =
      answer_of({"locate", terrain, "--points", points, "--columns", "number,name,y,x", "--json"});
  ASSERT_EQ(answer.at("points").size(), 4u);
  EXPECT_EQ(answer.at("points").at(3).at("height"), 55.0);

  std::string numbered;
  for (int i = 1; i < 5; ++i) numbered += std::to_string(i) + " " + east(i) + " " + south(i) + "\n";
  write_file(points, numbered);
  const Outcome refused = run_ptin({"locate", terrain, "--points", points});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--columns id x y"), std::string::npos) << refused.err;

  const std::string pair =
      "7," + south(20) + "," + east(4) + ",5," + south(20) + "," + east(28) + ",5\n";
  write_file(points, "id,lat1,lon1,h1,lat2,lon2,h2\n" + pair);
  const auto verdict = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"sight", terrain, "--pairs", points, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments).at("pairs").at(0).at("verdict");
  };
  EXPECT_EQ(verdict({}), "hidden");
  write_file(points, pair);
  EXPECT_EQ(verdict({"--columns", "id,y1,x1,h1,y2,x2,h2"}), "hidden");
  write_file(points, "from,to,a,b,c,d\n1,2,3,4,5,6\n");
  const Outcome unnamed = run_ptin({"sight", terrain, "--pairs", points});
  EXPECT_EQ(unnamed.status, 2);
  EXPECT_NE(unnamed.err.find("no column for x1"), std::string::npos) << unnamed.err;
}

TEST(LocateCommand, SaysWhenItCannotReadThePoints) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  std::filesystem::create_directory(folder.file("points"));
  const Outcome of_folder = run_ptin({"locate", terrain, "--points", folder.file("points")});
  EXPECT_EQ(of_folder.status, 2);
  EXPECT_NE(of_folder.err.find("folder"), std::string::npos) << of_folder.err;
  // It opens, and its first byte cannot be read.
  const Outcome fault = run_ptin({"locate", terrain, "--points", "/proc/self/mem"});
  EXPECT_EQ(fault.status, 6);
  EXPECT_NE(fault.err.find("/proc/self/mem"), std::string::npos) << fault.err;
}

// Under such a header the first two columns would be taken for coordinates.
TEST(LocateCommand, KnowsPointXAndRefusesAHeaderThatNamesNoCoordinate) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string row = "7," + east(15.5) + "," + south(20) + "\n";
  const Outcome known = testing::spawn_ptin_reading("id,POINT_X,POINT_Y\n" + row,
                                                    {"locate", terrain, "--points", "-"});
  EXPECT_EQ(known.status, 0) << known.err;
  EXPECT_NE(known.out.find("surface,55,55,55"), std::string::npos) << known.out;
  const Outcome refused =
      testing::spawn_ptin_reading("id,foo,bar\n" + row, {"locate", terrain, "--points", "-"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(lines_in(refused.err), 1u) << refused.err;
}

TEST(LocateCommand, SkipsCommentsBeforeAHeaderToo) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string text =
      "# y and x of one point\ny,x\n" + south(20) + "," + east(15.5) + "\n# the end\n";
  const Outcome outcome = testing::spawn_ptin_reading(text, {"locate", terrain, "--points", "-"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("surface,55,55,55"), std::string::npos) << outcome.out;
  EXPECT_EQ(lines_in(outcome.out), 2u) << outcome.out;
}

TEST(LocateCommand, TakesNumbersInQuotes) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string row = "\"" + east(15.5) + "\",\"" + south(20) + "\"\n";
  for (const std::string& text : {"x,y\n" + row, row + row}) {
    const Outcome outcome =
        testing::spawn_ptin_reading(text, {"locate", terrain, "--points", "-", "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json answer = json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(answer.is_object()) << outcome.out;
    EXPECT_EQ(answer.at("points").size(), lines_in(text) - (text[0] == 'x' ? 1 : 0));
    EXPECT_EQ(answer.at("points").at(0).at("height"), 55.0);
  }
}

TEST(ProfileCommand, BreaksAtEveryEdgeAndWritesThreeFormats) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string line =
      "LINESTRING(" + east(14) + " " + south(20) + "," + east(18) + " " + south(20) + ")";
  const json profile = answer_of({"profile", terrain, "--line", line, "--json"});
  ASSERT_EQ(profile.at("points").size(), 5u);  // along a row: a break at each sample
  EXPECT_EQ(profile.at("points").at(2).at("height"), 100.0);
  EXPECT_EQ(profile.at("length"), 120.0);
  for (const char* name : {"p.csv", "p.geojson", "p.png"}) {
    EXPECT_EQ(run_ptin({"profile", terrain, "--line", line, "-o", folder.file(name)}).status, 0);
    EXPECT_GT(std::filesystem::file_size(folder.file(name)), 50u);
  }
  const json written = json::parse(testing::read_file(folder.file("p.geojson")));
  EXPECT_EQ(written.at("crs").at("properties").at("name"), "urn:ogc:def:crs:EPSG::32611");
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", line, "-o", folder.file("p.doc")}).status, 2);
}

TEST(ProfileCommand, TakesExtensionsInCapitalsAndStdout) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string line =
      "LINESTRING(" + east(14) + " " + south(20) + "," + east(18) + " " + south(20) + ")";
  for (const char* name : {"P.CSV", "P.GeoJSON", "P.PNG"}) {
    EXPECT_EQ(run_ptin({"profile", terrain, "--line", line, "-o", folder.file(name)}).status, 0);
  }
  EXPECT_EQ(testing::read_file(folder.file("P.CSV")),
            run_ptin({"profile", terrain, "--line", line}).out);
  EXPECT_EQ(testing::read_file(folder.file("P.GeoJSON")),
            run_ptin({"profile", terrain, "--line", line, "-o", "-"}).out);
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", line, "-o", "-", "--json"}).status, 2);
}

TEST(PointQuestions, AnswerAtTheFirstVertices) {
  const TestFolder folder;
  const std::string terrain = testing::built(folder, "mountains_257.tif");
  const json info = answer_of({"info", terrain, "--json"});
  const double x =
      (info["bounds"]["min_x"].get<double>() + info["bounds"]["max_x"].get<double>()) / 2;
  const double y =
      (info["bounds"]["min_y"].get<double>() + info["bounds"]["max_y"].get<double>()) / 2;
  const std::string at_x = std::to_string(x + 7);
  const std::string at_y = std::to_string(y + 11);
  const json some = answer_of({"locate", terrain, at_x, at_y, "--vertices", "500", "--json"});
  const json refined =
      answer_of({"refine", terrain, "--vertices", "500", "-o", folder.file("m.ply"), "--json"});
  EXPECT_NEAR(some.at("certified_error").get<double>(), refined.at("certified_error").get<double>(),
              refined.at("certified_error").get<double>() / 8);
  EXPECT_EQ(some.at("exact"), false);
  const json exact = answer_of({"locate", terrain, at_x, at_y, "--json"});
  EXPECT_LE(some["points"][0]["height_min"], exact["points"][0]["height"]);
  EXPECT_GE(some["points"][0]["height_max"], exact["points"][0]["height"]);
  const std::string line =
      "LINESTRING(" + at_x + " " + at_y + "," + std::to_string(x) + " " + std::to_string(y) + ")";
  const json walked =
      answer_of({"profile", terrain, "--line", line, "--vertices", "500", "--json"});
  EXPECT_EQ(walked["points"][0]["height"], some["points"][0]["height"]);
  EXPECT_EQ(walked.at("certified_error"), some.at("certified_error"));
  EXPECT_EQ(run_ptin({"locate", terrain, at_x, at_y, "--vertices", "1"}).status, 2);
  EXPECT_EQ(run_ptin({"locate", terrain, at_x, at_y, "--vertices", "-5"}).status, 2);
  EXPECT_EQ(run_ptin({"locate", terrain, at_x, at_y, "--vertices", "500", "--error", "1"}).status,
            2);
  EXPECT_EQ(run_ptin({"locate", terrain, at_x, at_y, "--memory", "1K", "--by", "splits"}).status,
            7);
  const std::string across = "LINESTRING(" + at_x + " " + at_y + "," + at_x + " " +
                             std::to_string(info["bounds"]["max_y"].get<double>()) + ")";
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", across, "--memory", "1K"}).status, 7);
}

TEST(SightCommand, SeesOverAndNotThroughAWall) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const json low = answer_of({"sight", terrain, east(4), south(20), "5", east(28), south(20), "5",
                              "--curvature", "0", "--json"});
  EXPECT_EQ(low.at("verdict"), "hidden");
  EXPECT_NEAR(low.at("obstruction").at("distance").get<double>(), 30 * (11 + 5.0 / 90), 1e-6);
  EXPECT_NEAR(low.at("clearance").at("min").get<double>(), -85.0, 1e-9);
  const json high = answer_of({"sight", terrain, east(4), south(20), "90", east(28), south(20),
                               "90", "--curvature", "0", "--json"});
  EXPECT_EQ(high.at("verdict"), "visible");  // it touches
  EXPECT_NEAR(high.at("clearance").at("min").get<double>(), 0.0, 1e-9);
  const json bent =
      answer_of({"sight", terrain, east(4), south(20), "90", east(28), south(20), "90", "--json"});
  EXPECT_EQ(bent.at("verdict"), "hidden");  // the Earth's curvature is enough
  const json over_void =
      answer_of({"sight", terrain, east(31), south(1), "5", east(28), south(20), "5", "--json"});
  EXPECT_TRUE(over_void.at("verdict").is_null());
  EXPECT_EQ(over_void.at("ends").at(0), "void");
}

TEST(SightCommand, KeepsToItsBudgetAlsoOverVoidsAndInTheFresnelZone) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  for (const char* way : {"stars", "splits"}) {
    SCOPED_TRACE(way);
    const std::vector<std::string> pair = {"sight", terrain,  east(4),   south(20),
                                           "90",    east(28), south(20), "90",
                                           "--by",  way,      "--json"};
    const auto asked = [&](const std::vector<std::string>& more) {
      std::vector<std::string> arguments = pair;
      arguments.insert(arguments.end(), more.begin(), more.end());
      return answer_of(arguments);
    };
    const auto counted = [&](const json& answer) {
      const bool by_stars = way == std::string("stars");
      return answer.at("cost").at(by_stars ? "stars_read" : "records_retrieved").get<int>();
    };
    const json whole = asked({"--frequency", "1e9"});
    EXPECT_TRUE(whole.at("exact").get<bool>());
    EXPECT_EQ(whole.at("void_length"), 0.0);
    const json none = asked({"--frequency", "1e9", "--budget", "0"});
    EXPECT_EQ(counted(none), 0);
    EXPECT_EQ(none.at("verdict"), "undecided");
    EXPECT_FALSE(none.at("exact").get<bool>());
    EXPECT_TRUE(none.at("void_length").is_null());
    const json few = asked({"--frequency", "1e9", "--budget", "1"});
    EXPECT_GT(counted(few), 0);
    EXPECT_LT(counted(few), counted(whole));
    EXPECT_FALSE(few.at("exact").get<bool>());
    std::vector<std::string> negative = pair;
    negative.insert(negative.end(), {"--budget", "-1"});
    EXPECT_EQ(run_ptin(negative).status, 2);
  }
}

TEST(SightCommand, AnEndOnTheBorderStandsOnGround) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const json away = answer_of({"sight", terrain, east(0), south(20), "5", east(-9), south(20), "50",
                               "--absolute", "--json"});
  EXPECT_EQ(away.at("ends").at(0), "surface");
  EXPECT_EQ(away.at("ends").at(1), "outside");
  EXPECT_EQ(away.at("verdict"), "visible");
}

TEST(SightCommand, AnswersPairsInTheirOrder) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  std::string rows;
  for (int i = 0; i < 20; ++i) {
    const std::string height = i % 2 == 0 ? "1" : "200";
    rows += east(4) + " " + south(12 + i) + " " + height + " " + east(28) + " " + south(12 + i) +
            " " + height + "\n";
  }
  write_file(folder.file("pairs.txt"), rows);
  const json answers = answer_of({"sight", terrain, "--pairs", folder.file("pairs.txt"), "--json"});
  ASSERT_EQ(answers.at("pairs").size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(answers.at("pairs").at(i).at("verdict"), i % 2 == 0 ? "hidden" : "visible");
  }
}

}  // namespace
}  // namespace ptin::tools
