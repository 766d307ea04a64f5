// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bad input: the documented exit status, one clear sentence, and nothing left behind.
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using testing::expect_refusal;
using testing::make_raster;
using testing::Outcome;
using testing::RasterRecipe;
using testing::read_file;
using testing::run_ptin;
using testing::small_store;
using testing::TestFolder;
using testing::write_file;

/// Builds `input` and expects a refusal that leaves nothing but the input.
void expect_no_build(const TestFolder& folder, const std::string& input, int status,
                     const std::string& words, std::vector<std::string> extra = {}) {
  const auto before = folder.names();
  std::vector<std::string> arguments{"build", input, "-o", folder.file("out.ptin"), "-q"};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  expect_refusal(run_ptin(arguments), status, words);
  EXPECT_EQ(folder.names(), before);
}

TEST(CliBadUse, IsStatus2WithOneSentence) {
  expect_refusal(run_ptin({"frobnicate"}), 2, "frobnicate; see ptin --help");
  expect_refusal(run_ptin({"build"}), 2, "ptin build --help");
  expect_refusal(run_ptin({"refine", "a.ptin", "--window", "1", "2", "3", "-o", "x.ply"}), 2,
                 "--window");
  expect_refusal(run_ptin({"refine", "a.ptin", "--error", "soft", "-o", "x.ply"}), 2, "--error");
  expect_refusal(run_ptin({"refine", "a.ptin", "--error", "1", "--vertices", "9", "-o", "x.ply"}),
                 2, "--vertices");
  expect_refusal(run_ptin({"refine", "a.ptin", "--clip", "--cut", "-o", "x.ply"}), 2, "--cut");
}

/// And not an option that took what followed the one at fault.
TEST(CliBadUse, NamesTheOptionAtFault) {
  expect_refusal(run_ptin({"export", "a.ptin", "-of", "GTiff", "-o", "x.tif"}), 2,
                 "ptin: -of has one hyphen; the option is --of; see ptin export --help");
  expect_refusal(run_ptin({"export", "a.ptin", "-o", "x.tif", "-co=COMPRESS=NONE"}), 2, "-co has");
  expect_refusal(run_ptin({"refine", "a.ptin", "-error", "5", "-o", "x.ply"}), 2, "is --error");
  expect_refusal(run_ptin({"locate", "a.ptin", "--bogus", "val"}), 2,
                 "ptin: there is no option --bogus; see ptin locate --help");
  expect_refusal(run_ptin({"locate", "a.ptin", "1", "2", "-x", "val"}), 2, "no option -x;");
  expect_refusal(run_ptin({"sight", "a.ptin", "1", "2", "3", "-4", "-5.5", "--bogus=val"}), 2,
                 "no option --bogus;");
  expect_refusal(run_ptin({"build", "a.tif", "-o", "a.ptin", "-tr", "30", "30"}), 2,
                 "no option -tr;");
  expect_refusal(run_ptin({"--bogus", "info", "a.ptin"}), 2, "no option --bogus; see ptin --help");
  // Numbers below 0 and a hyphen for standard input or output are values.
  expect_refusal(run_ptin({"export", "none.ptin", "--nodata", "-9999", "-o", "x.tif"}), 3, "none");
  expect_refusal(run_ptin({"highest", "none.ptin", "--window", "-3", "-2", "-1", "-0.5"}), 3,
                 "none");
}

TEST(CliBadUse, IsJsonWhenAskedFor) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", "none.ptin", "--json"},
        {"build", "--json"},
        {"info", "--json", "--frobnicate"}}) {
    const Outcome outcome = run_ptin(arguments);
    const auto error = nlohmann::json::parse(outcome.err, nullptr, false);
    ASSERT_TRUE(error.is_object()) << outcome.err;
    EXPECT_TRUE(error.at("error").at("code").is_string());
    EXPECT_FALSE(error.at("error").at("message").get<std::string>().empty());
    EXPECT_EQ(outcome.status, error.at("error").at("code") == "not_found" ? 3 : 2);
  }
}

TEST(CliBadInput, MissingFile) {
  const TestFolder folder;
  expect_no_build(folder, folder.file("none.tif"), 3, "none.tif");
  expect_refusal(run_ptin({"info", folder.file("none.ptin")}), 3, "none.ptin");
  expect_refusal(run_ptin({"refine", folder.file("none.ptin"), "-o", folder.file("a.ply")}), 3,
                 "none.ptin");
  EXPECT_TRUE(folder.names().empty());
}

TEST(CliBadInput, NeitherRasterNorPoints) {
  const TestFolder folder;
  write_file(folder.file("prose.tif"), "It was a dark and stormy night.\n");
  expect_no_build(folder, folder.file("prose.tif"), 2, "prose.tif");
  write_file(folder.file("prose.csv"), "It was a dark and stormy night.\n");
  expect_no_build(folder, folder.file("prose.csv"), 2, "prose.csv");
  write_file(folder.file("empty.csv"), "");
  expect_no_build(folder, folder.file("empty.csv"), 2, "empty.csv");
  write_file(folder.file("strange.xyzzy"), "\x01\x02\x03");
  expect_no_build(folder, folder.file("strange.xyzzy"), 2, "strange.xyzzy");
}

TEST(CliBadInput, PointsThatMakeNoTriangle) {
  const TestFolder folder;
  write_file(folder.file("two.csv"), "0,0,1\n1,1,2\n");
  expect_no_build(folder, folder.file("two.csv"), 2, "two.csv");
  write_file(folder.file("line.csv"), "0,0,1\n1,1,2\n2,2,3\n3,3,3\n");
  expect_no_build(folder, folder.file("line.csv"), 2, "line.csv");
  write_file(folder.file("nan.csv"), "0,0,1\n1,0,nan\n2,2,3\n");
  expect_no_build(folder, folder.file("nan.csv"), 2, "nan.csv");
  write_file(folder.file("inf.csv"), "0,0,1\n1,0,inf\n2,2,3\n");
  expect_no_build(folder, folder.file("inf.csv"), 2, "inf.csv");
}

TEST(CliBadInput, RastersThatAreNoTerrain) {
  const TestFolder folder;
  RasterRecipe row;
  row.width = 1;
  make_raster(folder.file("column.tif"), row);
  expect_no_build(folder, folder.file("column.tif"), 2, "column.tif");
  RasterRecipe infinite;
  infinite.value = [](int x, int y) {
    return x == 3 && y == 4 ? std::numeric_limits<double>::infinity() : 1.0;
  };
  make_raster(folder.file("infinite.tif"), infinite);
  expect_no_build(folder, folder.file("infinite.tif"), 2, "infinite.tif");
  make_raster(folder.file("hills.tif"), {});
  const std::string places = "x from 500015.000000 to 500975.000000, y from 3999025.000000 to";
  expect_no_build(folder, folder.file("hills.tif"), 2, places, {"--bbox", "1", "1", "2", "2"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "give x before y",
                  {"--bbox", "3999100", "500100", "3999500", "500500"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "--max-error", {"--max-error", "-1"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "--void-slope", {"--void-slope", "-1"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "--resolution", {"--resolution", "0"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "--void-slope: must be a finite",
                  {"--void-slope", "nan"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "inverted", {"--bbox", "2", "1", "1", "2"});
  expect_no_build(folder, folder.file("hills.tif"), 2, "EPSG:999999", {"--a-srs", "EPSG:999999"});
}

TEST(CliBadInput, RotatedRastersAndRastersWithoutABand) {
  const TestFolder folder;
  make_raster(folder.file("hills.tif"), {});
  write_file(folder.file("rotated.vrt"),
             "<VRTDataset rasterXSize=\"33\" rasterYSize=\"33\">"
             "<GeoTransform>0, 1, 0.5, 0, 0.5, -1</GeoTransform>"
             "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
             "<SourceFilename relativeToVRT=\"1\">hills.tif</SourceFilename>"
             "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
  expect_no_build(folder, folder.file("rotated.vrt"), 2, "rotated or sheared");
  write_file(folder.file("none.vrt"), "<VRTDataset rasterXSize=\"33\" rasterYSize=\"33\"/>");
  expect_no_build(folder, folder.file("none.vrt"), 2, "bands");
}

TEST(CliBadInput, OutputThatCannotBe) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const std::string before = read_file(store);
  expect_refusal(run_ptin({"build", folder.file("hills.tif"), "-o", store, "-q"}), 2,
                 "--overwrite");
  EXPECT_EQ(read_file(store), before);
  EXPECT_EQ(run_ptin({"build", folder.file("hills.tif"), "-o", store, "-q", "--overwrite"}).status,
            0);
  expect_refusal(run_ptin({"refine", store, "-o", folder.file("a.doc")}), 2,
                 ".ply, .obj, .2dm, .glb");
  expect_refusal(run_ptin({"render", store, "-o", folder.file("a.jpg")}), 2, ".png");
  write_file(folder.file("a.ply"), "mine");
  expect_refusal(run_ptin({"refine", store, "-o", folder.file("a.ply")}), 2, "--overwrite");
  EXPECT_EQ(read_file(folder.file("a.ply")), "mine");
  expect_refusal(run_ptin({"refine", store, "-o", folder.file("none/a.ply")}), 3, "none");
  const std::vector<std::string> left = {"a.ply", "hills.ptin", "hills.tif"};
  EXPECT_EQ(folder.names(), left);
}

TEST(CliBadInput, OutputThatIsADeviceOrAPipe) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  ASSERT_EQ(mkfifo(folder.file("pipe.ply").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", folder.file("null.ply"));
  for (const char* name : {"pipe.ply", "null.ply"}) {
    expect_refusal(run_ptin({"refine", store, "--overwrite", "-o", folder.file(name)}), 2,
                   "device or a pipe");
  }
  EXPECT_TRUE(std::filesystem::is_fifo(folder.file("pipe.ply")));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("null.ply")));
}

TEST(CliBadInput, QuestionsOutOfContract) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const std::string out = folder.file("a.ply");
  expect_refusal(run_ptin({"refine", store, "--window", "5", "5", "1", "9", "-o", out}), 2,
                 "inverted");
  expect_refusal(run_ptin({"refine", store, "--window", "nan", "5", "6", "9", "-o", out}), 2,
                 "finite");
  expect_refusal(run_ptin({"refine", store, "--error", "-1", "-o", out}), 2, "--error");
  expect_refusal(run_ptin({"refine", store, "--vertices", "1", "-o", out}), 2, "vertices");
  expect_refusal(run_ptin({"refine", store, "--clip", "-o", out}), 2, "region");
  expect_refusal(run_ptin({"refine", store, "--point", "1", "2", "--cut", "-o", out}), 2, "--cut");
  expect_refusal(run_ptin({"refine", store, "--polygon", "POLYGON((1 2", "-o", out}), 2, "WKT");
  expect_refusal(run_ptin({"refine", store, "--polygon", folder.file("none.wkt"), "-o", out}), 3,
                 "none.wkt");
  expect_refusal(run_ptin({"refine", store, "--memory", "4K", "-o", out}), 7, "limit");
  expect_refusal(run_ptin({"refine", store, "--memory", "much", "-o", out}), 2, "512M");
  expect_refusal(run_ptin({"render", store, "--window", "500100", "3999100", "500100", "3999500",
                           "-o", folder.file("a.png")}),
                 2, "area");
  const std::vector<std::string> left = {"hills.ptin", "hills.tif"};
  EXPECT_EQ(folder.names(), left);
}

/// Every question that takes a region, without its region, and the option that gives it a window.
std::vector<std::pair<std::vector<std::string>, std::string>> questions_with_windows(
    const TestFolder& folder, const std::string& store) {
  return {
      {{"refine", store, "-o", folder.file("a.ply")}, "--window"},
      {{"refine", store, "--clip", "-o", folder.file("a.ply")}, "--window"},
      {{"export", store, "-o", folder.file("a.ply")}, "--window"},
      {{"export", store, "-o", folder.file("a.tif")}, "--window"},
      {{"isoline", store, "-i", "10", "-o", folder.file("a.gpkg")}, "--window"},
      {{"isoline", store, "-i", "10", "-p", "-o", folder.file("a.gpkg")}, "--window"},
      {{"highest", store}, "--window"},
      {{"volume", store, "--level", "1"}, "--window"},
      {{"render", store, "-o", folder.file("a.png")}, "--window"},
      {{"stream", store, "-o", folder.file("b.pts")}, "--window"},
      {{"stream", store, "-o", folder.file("b.pts")}, "--have-window"},
      {{"unstream", folder.file("a.pts"), "-i", "10", "-o", folder.file("a.gpkg")}, "--window"}};
}

TEST(CliBadInput, RegionsThatMissTheTerrainAreRefusedWithItsBounds) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  testing::expect_done({"stream", store, "-o", folder.file("a.pts")});
  const auto before = folder.names();
  const auto refuse = [&](std::vector<std::string> arguments,
                          const std::vector<std::string>& region, const std::string& words) {
    arguments.insert(arguments.end(), region.begin(), region.end());
    const std::string option = region[0].starts_with('-') ? region[0] : "X Y";
    const Outcome outcome = run_ptin(arguments);
    expect_refusal(outcome, 2, "ptin: " + option + ": this misses the terrain");
    expect_refusal(outcome, 2, words);
    EXPECT_EQ(folder.names(), before) << arguments[0];
  };
  const std::string bounds = "x from 500015 to 500975, y from 3999025 to 3999985";
  const std::string hint = bounds + "; with x and y exchanged it would not: give x before y\n";
  for (const auto& [question, option] : questions_with_windows(folder, store)) {
    refuse(question, {option, "1", "2", "3", "4"}, bounds + "\n");
    refuse(question, {option, "3999100", "500100", "3999500", "500500"}, hint);
  }
  for (const std::vector<std::string>& question :
       {std::vector<std::string>{"refine", store, "-o", folder.file("a.ply")},
        {"export", store, "-o", folder.file("a.ply")}}) {
    refuse(question, {"--polygon", "POLYGON((1 1, 9 1, 5 9))"}, bounds + "\n");
    // Around the terrain, and not over it.
    refuse(question,
           {"--polygon",
            "POLYGON((0 0, 9e6 0, 9e6 9e6, 0 9e6), (4e5 3e6, 6e5 3e6, 6e5 5e6, 4e5 5e6))"},
           bounds);
    refuse(question, {"--polygon", "POLYGON((3999100 500100, 3999500 500200, 3999300 500500))"},
           hint);
  }
  refuse({"refine", store, "-o", folder.file("a.ply")}, {"--point", "3999100", "500100"}, hint);
  refuse({"viewshed", store, "-o", folder.file("a.tif"), "--radius", "500"},
         {"3999100", "500100", "2"}, hint);
  refuse({"stream", store, "-o", folder.file("b.pts")}, {"--have", R"([{"window":[1,2,3,4]}])"},
         bounds + "\n");
}

TEST(CliBadInput, RegionsThatTouchTheTerrainAreAnswered) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  for (auto [question, option] : questions_with_windows(folder, store)) {
    if (question[0] != "refine" && question[0] != "highest" && question[0] != "stream") continue;
    question.insert(question.end(), {option, "400000", "3000000", "500015", "3999025", "--json"});
    if (question[0] != "highest") question.emplace_back("--overwrite");
    EXPECT_EQ(run_ptin(question).status, 0) << question[0] << " " << option;
  }
}

TEST(CliBadInput, QuestionsThatMeanNothing) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const auto before = folder.names();
  const std::string tif = folder.file("v.tif");
  const std::string gpkg = folder.file("v.gpkg");
  const auto refuse = [&](std::vector<std::string> arguments, int status,
                          const std::string& words) {
    arguments.insert(arguments.begin() + 1, store);
    expect_refusal(run_ptin(arguments), status, words);
    EXPECT_EQ(folder.names(), before);
  };
  for (const std::vector<std::string>& question :
       {std::vector<std::string>{"locate", "0", "0"},
        {"profile", "--line", "LINESTRING(0 0, 1 1)"},
        {"sight", "0", "0", "1", "1", "1", "1"},
        {"highest"},
        {"volume", "--level", "1"},
        {"isoline", "-i", "10", "-o", gpkg},
        {"viewshed", "500100", "3999900", "1", "--radius", "9", "-o", tif}}) {
    const auto with = [&](const std::vector<std::string>& more) {
      std::vector<std::string> arguments = question;
      arguments.insert(arguments.end(), more.begin(), more.end());
      return arguments;
    };
    refuse(with({"--error", "-1"}), 2, "--error: must be a number >= 0");
    refuse(with({"--error", "nan"}), 2, "--error: must be a number >= 0");
    refuse(with({"--error", "1", "--vertices", "9"}), 2, "--vertices");
    refuse(with({"--vertices", "1"}), 2, "ask for at least that many");
    refuse(with({"--vertices", "-1"}), 2, "--vertices");
    for (const char* size : {"0", "nan", "inf", "-1M"}) {
      refuse(with({"--memory", size}), 2, std::string("--memory: not a size: ") + size);
    }
  }
  refuse({"volume"}, 2, "--level H..., --interval D or --against OTHER");
  refuse({"volume", "--level", "1", "--against", store}, 2, "--against");
  refuse({"volume", "--level", "nan"}, 2, "--level: must be a finite number");
  refuse({"volume", "--level", "1", "--memory", "1K"}, 7, "more than the limit of 1");
  refuse({"volume", "--level", "1", "--memory", "128"}, 2,
         "--memory: 128 is 128 bytes; did you mean 128M?");
  refuse({"highest", "--memory", "4"}, 2, "--memory: 4 is 4 bytes; did you mean 4G?");
  refuse({"volume", "--against", folder.file("none.ptin")}, 3, "none.ptin");
  refuse({"highest", "-k", "1000", "--memory", "1K"}, 7, "more than the limit of 1");
  refuse({"highest", "-k", "0"}, 2, "-k");
  refuse({"highest", "--window", "3", "2", "1", "4"}, 2, "inverted");
  refuse({"viewshed", "0", "0", "1", "--radius", "9", "-o", folder.file("v.png")}, 2,
         "must end in .tif for a raster");
}

/// Every number that a subcommand takes: what is none is refused by its option's or argument's name.
TEST(CliBadInput, NumbersThatAreNone) {
  const TestFolder folder;
  const std::string store = small_store(folder), raster = folder.file("hills.tif");
  const std::string tif = folder.file("a.tif"), layer = folder.file("a.gpkg");
  const std::string sent = folder.file("a.pts"), picture = folder.file("a.png");
  using Command = std::vector<std::string>;
  const Command build = {"build", raster, "-o", folder.file("b.ptin")};
  const Command viewshed = {"viewshed", store, "500100", "3999900", "1", "-o", tif};
  const Command sight = {"sight", store, "0", "0", "1", "9", "9", "1"};
  const Command isoline = {"isoline", store, "-o", layer};
  const Command stream = {"stream", store, "-o", sent};
  const Command unstream = {"unstream", sent, "-o", layer};
  const std::vector<std::pair<Command, std::string>> finite = {
      {build, "--max-error"},
      {build, "--void-slope"},
      {build, "--resolution"},
      {build, "--max-edge"},
      {viewshed, "--radius"},
      {viewshed, "--target-height"},
      {viewshed, "--curvature"},
      {sight, "--curvature"},
      {isoline, "--level"},
      {isoline, "--interval"},
      {stream, "--level"},
      {stream, "--have-level"},
      {unstream, "--level"},
      {unstream, "--interval"},
      {{"volume", store}, "--level"},
      {{"bench", store}, "--seconds"},
      {{"refine", store, "-o", folder.file("a.stl")}, "--exaggeration"},
      {{"verify", store, "--against", raster}, "--tolerance"},
      {{"export", store, "-o", tif, "--what", "hillshade"}, "--azimuth"},
      {{"export", store, "-o", tif, "--what", "hillshade"}, "--altitude"},
      {{"export", store, "-o", tif}, "--pixel-size"},
      {{"isoline", store, "-o", layer, "--interval", "9"}, "--base"}};
  const auto before = folder.names();
  const auto refuse = [&](Command words, const std::string& option, const std::string& number) {
    words.insert(words.end(), {option, number});
    expect_refusal(run_ptin(words), 2, option + ": ");
  };
  for (const char* number : {"nan", "inf", "1e999", " nan"}) {
    for (const auto& [words, option] : finite) refuse(words, option, number);
    expect_refusal(run_ptin({"locate", store, number, "3"}), 2,
                   std::string("X_Y: must be a finite number, in map units; ") + number);
    expect_refusal(run_ptin({"sight", store, "1", "2", "3", "4", "5", number}), 2, "PAIR: must be");
    expect_refusal(run_ptin({"viewshed", store, "1", number, "2", "--radius", "9", "-o", tif}), 2,
                   "Y: must be a finite number, in map units");
    Command words = build;
    words.insert(words.end(), {"--bbox", "0", "0", number, "9"});
    expect_refusal(run_ptin(words), 2, "--bbox: must be");
  }
  // As coarse as can be is a tolerance.
  for (const char* number : {"nan", "-1"}) {
    refuse(stream, "--error", number);
    refuse(stream, "--have-error", number);
  }
  EXPECT_EQ(folder.names(), before);
}

TEST(CliBadInput, OptionsThatMeanNothingToARaster) {
  const TestFolder folder;
  make_raster(folder.file("hills.tif"), {});
  const std::string raster = folder.file("hills.tif");
  expect_no_build(folder, raster, 2, "--resolution is for points", {"--resolution", "2"});
  expect_no_build(folder, raster, 2, "--class is for LAS", {"--class", "2"});
  expect_no_build(folder, raster, 2, "--repair is for TINs", {"--repair"});
  expect_no_build(folder, raster, 2, "--progress-fd: must be a whole number >= 0; -1 is none; see",
                  {"--progress-fd", "-1"});
}

TEST(CliBadInput, ServingsThatAreNoCounts) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const auto before = folder.names();
  for (const char* splits : {"-5", "5.7", "1e300", "\"5\"", "true"}) {
    expect_refusal(run_ptin({"stream", store, "-o", folder.file("a.pts"), "--have",
                             std::string("[{\"splits\":") + splits + "}]"}),
                   2, "--have");
  }
  EXPECT_EQ(folder.names(), before);
}

/// Of which the system lets nobody read the first byte.
TEST(BadInput, LayersThatCannotBeReadAreNotOfAnUnknownKind) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  for (const char* name : {"a.gpkg", "a.geojson", "a.gpx"}) {
    std::filesystem::create_symlink("/proc/self/mem", folder.file(name));
    const std::string layer = folder.file(name);
    expect_refusal(run_ptin({"locate", store, "--points", layer}), 6, "cannot read");
    expect_refusal(run_ptin({"profile", store, "--line", layer}), 6, "cannot read");
  }
}

/// What the system does not tell is an error of input or output, not a fault of the program.
TEST(BadInput, NamesThatTheSystemRefusesAreErrorsOfTheirOwn) {
  const TestFolder folder;
  const std::string store = testing::built(folder, "ground_points.csv");
  const std::string too_long = folder.file(std::string(300, 'a'));
  std::filesystem::create_symlink("circle", folder.file("circle"));
  for (const std::string& name : {too_long, folder.file("circle")}) {
    EXPECT_EQ(run_ptin({"verify", store, "--against", name}).status, 6) << name;
    EXPECT_EQ(run_ptin({"locate", store, "--points", name}).status, 6) << name;
  }
  const auto resumed =
      run_ptin({"build", testing::test_data("ground_points.csv"), "--resume", "-o", too_long});
  EXPECT_EQ(resumed.status, 6) << resumed.err;
}

}  // namespace
}  // namespace ptin::tools
