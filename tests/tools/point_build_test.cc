// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin build` over points: which of them it takes, and that `verify --against` knows what was left
// out.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/las_file.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

nlohmann::json built_points(const TestFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "build");
  arguments.insert(arguments.end(), {"-o", folder.file("out.ptin"), "--overwrite", "--json"});
  const auto outcome = run_ptin(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out, nullptr, false);
}

void expect_verified(const TestFolder& folder, const std::string& source) {
  const auto outcome =
      run_ptin({"verify", folder.file("out.ptin"), "--against", folder.file(source), "-q"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

/// Ground (2) on a grid, and trees (5) and water (9) between its points.
std::string las() {
  LasFileMaker file;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      file.points.push_back({100 * x, 100 * y, 10 * x + y, 2});
      file.points.push_back({100 * x + 50, 100 * y + 50, 500, x % 2 == 0 ? 5 : 9});
    }
  }
  return file.bytes();
}

TEST(PointBuild, TakesTheClassesOfLasThatAreAskedFor) {
  const TestFolder folder;
  write_file(folder.file("a.las"), las());
  EXPECT_EQ(built_points(folder, {folder.file("a.las")})["samples"], 288);
  const auto ground = built_points(folder, {folder.file("a.las"), "--class", "2"});
  EXPECT_EQ(ground["samples"], 144);
  EXPECT_EQ(ground["left_out_points"], 144);
  expect_verified(folder, "a.las");
  EXPECT_EQ(built_points(folder, {folder.file("a.las"), "--class", "2,9"})["samples"], 216);
  const auto none = run_ptin(
      {"build", folder.file("a.las"), "--class", "7", "-o", folder.file("none.ptin"), "--json"});
  EXPECT_EQ(none.status, 2) << none.err;
  EXPECT_NE(none.err.find("class"), std::string::npos) << none.err;
}

// Point, northing, easting, height, code: what surveyors' programs write.
TEST(PointBuild, ReadsTheColumnsThatAreNamed) {
  const TestFolder folder;
  std::string text, plain;
  for (int i = 0; i < 60; ++i) {
    const std::string x = std::to_string(2254 + i % 8) + ".230";
    const std::string y = std::to_string(5026 + i / 8) + ".873";
    const std::string z = std::to_string(95 + i * i % 13) + ".643";
    text += std::to_string(i + 1) + "," + y + "," + x + "," + z + ",\"GND, " + "wet\"\n";
    plain += x + " " + y + " " + z + "\n";
  }
  write_file(folder.file("pnezd.txt"), text);
  write_file(folder.file("plain.xyz"), plain);
  const auto refused =
      run_ptin({"build", folder.file("pnezd.txt"), "-o", folder.file("out.ptin"), "-q"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--columns"), std::string::npos) << refused.err;
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"plain.xyz", "pnezd.txt"}));

  const auto built =
      built_points(folder, {folder.file("pnezd.txt"), "--columns", "id", "y", "x", "z", "code"});
  EXPECT_EQ(built["samples"], 60);
  expect_verified(folder, "pnezd.txt");
  const auto bounds = [&] {
    return testing::answer_of({"info", folder.file("out.ptin"), "--json"}).at("bounds");
  };
  const nlohmann::json named = bounds();
  built_points(folder, {folder.file("plain.xyz")});
  EXPECT_EQ(bounds(), named);
  built_points(folder, {folder.file("pnezd.txt"), "--columns", "P,N,E,Z,D"});
  EXPECT_EQ(bounds(), named);

  write_file(folder.file("a.las"), las());
  for (const char* input : {"a.las", "mountains_257.tif"}) {
    const std::string path =
        std::string(input) == "a.las" ? folder.file(input) : testing::test_data(input);
    const auto none = run_ptin({"build", path, "-o", folder.file("no.ptin"), "--columns", "x,y,z"});
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find("--columns is for points as text"), std::string::npos) << none.err;
  }
  const auto without_input =
      run_ptin({"build", "-o", folder.file("no.ptin"), "--columns", "x", "y", "z", "pnezd.txt"});
  EXPECT_EQ(without_input.status, 2);
  EXPECT_NE(without_input.err.find("put INPUT before it"), std::string::npos) << without_input.err;
  const auto without_z = run_ptin({"build", folder.file("pnezd.txt"), "-o", folder.file("no.ptin"),
                                   "--columns", "id", "y", "x"});
  EXPECT_EQ(without_z.status, 2);
  EXPECT_NE(without_z.err.find("no column for z"), std::string::npos) << without_z.err;
}

/// Two inputs that share four positions; at the origin heights are 30 and 10, then 20.
std::vector<std::string> points_that_fall_together(const TestFolder& folder) {
  write_file(folder.file("a.xyz"), "0 0 30\n9 0 1\n0 9 2\n9 9 3\n5 4 7\n0 0 10\n");
  write_file(folder.file("b.xyz"), "0 0 20\n9 0 1\n0 9 2\n9 9 3\n");
  return {folder.file("a.xyz"), folder.file("b.xyz")};
}

double height_at_origin(const TestFolder& folder) {
  return testing::answer_of(
      {"locate", folder.file("out.ptin"), "0", "0", "--json"})["points"][0]["height"];
}

TEST(PointBuild, MergesPointsThatFallTogetherByTheRule) {
  const TestFolder folder;
  const std::vector<std::string> inputs = points_that_fall_together(folder);
  const struct {
    const char* rule;
    double height, shift;
  } cases[] = {{"mean", 20, 10}, {"min", 10, 20}, {"max", 30, 20}, {"first", 30, 20}};
  for (const auto& c : cases) {
    const auto report = built_points(folder, {inputs[0], inputs[1], "--duplicates", c.rule});
    EXPECT_EQ(report["merged_points"], 5) << c.rule;
    EXPECT_EQ(report["largest_shift"]["height"], c.shift) << c.rule;
    EXPECT_EQ(report["largest_shift"]["height_steps"], c.shift) << c.rule;
    EXPECT_EQ(height_at_origin(folder), c.height) << c.rule;
    const auto verified =
        run_ptin({"verify", folder.file("out.ptin"), "--against", inputs[0], inputs[1], "-q"});
    EXPECT_EQ(verified.status, 0) << c.rule << verified.out << verified.err;
  }
  built_points(folder, {inputs[1], inputs[0], "--duplicates", "first"});
  EXPECT_EQ(height_at_origin(folder), 20);
  built_points(folder, inputs);
  EXPECT_EQ(height_at_origin(folder), 20) << "the mean";
}

TEST(PointBuild, WarnsWhereMergingMovedAHeightFar) {
  const TestFolder folder;
  write_file(folder.file("near.xyz"), "0 0 1\n9 0 1\n0 9 2\n0 0 201\n");
  write_file(folder.file("far.xyz"), "0 0 1\n9 0 1\n0 9 2\n0 0 203\n");
  const auto warning = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"build", folder.file(name), "-o", folder.file("out.ptin"),
                               "--overwrite", "--a-srs", "EPSG:32611"});
    const std::string err = run_ptin(more).err;
    const std::size_t at = err.find("ptin: warning: ");
    return at == err.npos ? "" : err.substr(at, err.find('\n', at) - at);
  };
  EXPECT_EQ(warning("near.xyz", {}), "") << "a hundred steps";
  const std::string told = warning("far.xyz", {});
  EXPECT_NE(told.find("at heights up to 101 (101 steps of 1) away"), std::string::npos) << told;
  EXPECT_NE(told.find("--duplicates"), std::string::npos) << told;
  EXPECT_EQ(warning("far.xyz", {"-q"}), "");
  EXPECT_EQ(warning("far.xyz", {"--duplicates", "mean"}), "") << "who chose a rule knows";
}

TEST(PointBuild, CountsPointsThatAreLeftOutByReason) {
  const TestFolder folder;
  LasFileMaker file;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) file.points.push_back({100 * x, 100 * y, 10 * x + y + 1, 2});
  }
  file.points.push_back({100, 100, 7, 7});               // of another class
  file.points.push_back({100, 100, 7, 7, true});         // and withheld, which comes first
  file.points.push_back({100, 100, 7, 2, false, 1, 2});  // not the last return
  file.points.push_back({100, 100, 0, 2});               // of no height
  file.points.push_back({90000, 0, 7, 2});               // outside
  file.points.push_back({90000, 0, 7, 2});
  write_file(folder.file("a.las"), file.bytes());
  const std::vector<std::string> choices = {folder.file("a.las"),
                                            "--class",
                                            "2",
                                            "--returns",
                                            "last",
                                            "--nodata",
                                            "0",
                                            "--bbox",
                                            "-1",
                                            "-1",
                                            "9",
                                            "9"};
  const auto built = built_points(folder, choices);
  EXPECT_EQ(built["left_out_points"], 6);
  EXPECT_EQ(built["left_out"], (nlohmann::json{{"invalid", 0},
                                               {"withheld", 1},
                                               {"class", 1},
                                               {"return", 1},
                                               {"no_height", 0},
                                               {"nodata", 1},
                                               {"bbox", 2},
                                               {"boundary", 0},
                                               {"no_triangle", 0}}));
  std::vector<std::string> in_words = {"build", "-o", folder.file("words.ptin")};
  in_words.insert(in_words.end(), choices.begin(), choices.end());
  const auto words = run_ptin(in_words);
  EXPECT_NE(
      words.out.find("6 points: 1 withheld, 1 of another class, 1 of another return, 1 with the "
                     "height of --nodata, 2 outside of --bbox\n"),
      std::string::npos)
      << words.out << words.err;
}

TEST(PointBuild, PassesOverRowsThatAreNoPointsWhereItMay) {
  const TestFolder folder;
  write_file(folder.file("a.csv"), "x,y,z\n0,0,1\n9,0,nan\n9,0,2\n0,9\n0,9,3\n9,9,4\n");
  const auto refused =
      run_ptin({"build", folder.file("a.csv"), "-o", folder.file("out.ptin"), "--overwrite"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("a.csv:3: "), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--skip-invalid"), std::string::npos) << refused.err;
  const auto built = built_points(folder, {folder.file("a.csv"), "--skip-invalid"});
  EXPECT_EQ(built["samples"], 4);
  EXPECT_EQ(built["left_out"]["invalid"], 2);
  EXPECT_EQ(built["warnings"][0]["kind"], "invalid_rows");
  EXPECT_EQ(built["warnings"][0]["line"], 3);
  EXPECT_EQ(built["warnings"][0]["count"], 2);
  expect_verified(folder, "a.csv");
}

TEST(PointBuild, TakesTheReturnsOfLasThatAreAskedFor) {
  const TestFolder folder;
  LasFileMaker file;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      file.points.push_back({100 * x, 100 * y, 3000, 5, false, 1, 2});
      file.points.push_back({100 * x, 100 * y, 10 * x + y, 2, false, 2, 2});
    }
  }
  write_file(folder.file("a.las"), file.bytes());
  const auto last = built_points(folder, {folder.file("a.las"), "--returns", "last"});
  EXPECT_EQ(last["left_out_points"], 25);
  EXPECT_EQ(last["merged_points"], 0);
  EXPECT_EQ(height_at_origin(folder), 0);
  expect_verified(folder, "a.las");
  built_points(folder, {folder.file("a.las"), "--returns", "first"});
  EXPECT_EQ(height_at_origin(folder), 30);
  built_points(folder, {folder.file("a.las"), "--returns", "all", "--duplicates", "min"});
  EXPECT_EQ(height_at_origin(folder), 0);
  expect_verified(folder, "a.las");
}

TEST(PointBuild, RefusesChoicesThatMeanNothing) {
  const TestFolder folder;
  write_file(folder.file("a.xyz"), "0 0 1\n9 0 1\n0 9 2\n");
  write_file(folder.file("a.obj"), "v 0 0 1\nv 9 0 1\nv 0 9 2\nf 1 2 3\n");
  const struct {
    std::string input;
    std::vector<std::string> options;
  } cases[] = {{folder.file("a.xyz"), {"--returns", "last"}},
               {folder.file("a.obj"), {"--returns", "first"}},
               {folder.file("a.obj"), {"--duplicates", "min"}},
               {testing::test_data("coast_257.tif"), {"--returns", "last"}},
               {testing::test_data("coast_257.tif"), {"--duplicates", "mean"}}};
  for (const auto& c : cases) {
    const auto refused = run_ptin(
        {"build", c.input, "-o", folder.file("none.ptin"), "-q", c.options[0], c.options[1]});
    EXPECT_EQ(refused.status, 2) << c.input << c.options[0];
    EXPECT_NE(refused.err.find(c.options[0] == "--returns" ? "returns" : "--duplicates"),
              std::string::npos)
        << refused.err;
  }
}

/// Two layers of points in one file.
std::string two_layers() {
  return R"(<?xml version="1.0"?><gpx version="1.1" creator="test" xmlns="http://www.topografix.com/GPX/1/1">
<wpt lat="46.00" lon="7.00"><ele>100</ele></wpt><wpt lat="46.01" lon="7.00"><ele>110</ele></wpt>
<wpt lat="46.00" lon="7.01"><ele>120</ele></wpt><wpt lat="46.01" lon="7.01"><ele>135</ele></wpt>
<trk><trkseg><trkpt lat="46.00" lon="7.00"><ele>1</ele></trkpt>
<trkpt lat="46.02" lon="7.00"><ele>2</ele></trkpt><trkpt lat="46.00" lon="7.02"><ele>3</ele></trkpt>
</trkseg></trk></gpx>)";
}

TEST(PointBuild, TakesALayerAndAnAttributeForTheHeights) {
  const TestFolder folder;
  write_file(folder.file("a.gpx"), two_layers());
  const auto points = built_points(folder, {folder.file("a.gpx"), "--layer", "waypoints",
                                            "--z-field", "ele", "--resolution", "0.0001"});
  EXPECT_EQ(points["samples"], 4);
  expect_verified(folder, "a.gpx");
  const auto track = built_points(folder, {folder.file("a.gpx"), "--layer", "track_points",
                                           "--z-field", "ele", "--resolution", "0.0001"});
  EXPECT_EQ(track["samples"], 3);
  const auto wrong = run_ptin({"build", folder.file("a.gpx"), "--layer", "nothing", "--z-field",
                               "ele", "-o", folder.file("none.ptin")});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("nothing"), std::string::npos) << wrong.err;
}

TEST(PointBuild, MakesTrianglesWithLongEdgesVoidAndVerifyKnowsTheLonePoints) {
  const TestFolder folder;
  std::string text;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(x * y % 7) + "\n";
    }
  }
  text += "100 0 5\n100 100 6\n0 100 7\n";  // far from each other and from all else
  write_file(folder.file("a.xyz"), text);
  const auto with_voids = built_points(folder, {folder.file("a.xyz"), "--max-edge", "2"});
  EXPECT_EQ(with_voids["lone_samples"], 3);
  expect_verified(folder, "a.xyz");
  EXPECT_EQ(built_points(folder, {folder.file("a.xyz"), "--max-edge", "200"})["lone_samples"], 0);
  expect_verified(folder, "a.xyz");
  // Without the lone points in the source, something is wrong.
  write_file(folder.file("other.xyz"), text.substr(0, text.find("100 0 5")));
  built_points(folder, {folder.file("a.xyz"), "--max-edge", "2"});
  EXPECT_NE(
      run_ptin({"verify", folder.file("out.ptin"), "--against", folder.file("other.xyz"), "-q"})
          .status,
      0);
}

// Half a step is no double here: a build and a verification that round it apart see other points.
TEST(PointBuild, RoundsCoordinatesInTheMiddleOfTwoStepsAsVerifyDoes) {
  const TestFolder folder;
  std::string text = "x,y,z\n";
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const std::string east = std::to_string(481200 + x) + "." + std::to_string(10 + 3 * x) + "50";
      const std::string north =
          std::to_string(3912300 + y) + "." + std::to_string(20 + (7 * x + y) % 70) + "50";
      text += east + "," + north + "," + std::to_string((x * y) % 13) + ".25\n";
    }
  }
  write_file(folder.file("a.csv"), text);
  built_points(folder, {folder.file("a.csv"), "--resolution", "0.01"});
  expect_verified(folder, "a.csv");
}

// At 123 456 789 the next double is 1.5e-8 away: digits beyond that are dropped.
TEST(PointBuild, HasNoGridFinerThanItsCoordinates) {
  const TestFolder folder;
  write_file(folder.file("a.csv"),
             "x,y,z\n123456789.012345678,5.000000001,1\n123456789.012345679,5.000000004,2\n"
             "123456789.012345671,5.000000009,3\n123456789.012345673,5.000000002,4\n");
  const auto outcome = run_ptin({"build", folder.file("a.csv"), "-o", folder.file("a.ptin"), "-q"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("1 distinct points"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.csv"});
}

TEST(PointBuild, SaysBeforeItReadsWhatItExpectsToNeed) {
  const TestFolder folder;
  write_file(folder.file("a.las"), las());
  const auto outcome = run_ptin({"build", folder.file("a.las"), "-o", folder.file("out.ptin"),
                                 "--tile", "6", "--dry-run", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("writing"), std::string::npos) << outcome.err;
  const auto plan = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(plan["estimated"], true);
  EXPECT_GE(plan["temporary_bytes"], 288 * 43);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.las"});
}

}  // namespace
}  // namespace ptin::tools
