// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin build` over the files of a lidar survey: tiles whose declarations differ, empty tiles, tiles
// named twice, folders of tiles, and classes as people write them.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/las_file.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

using Entry = std::array<std::uint16_t, 4>;
constexpr Entry kProjected{1024, 0, 1, 1}, kZone32{3072, 0, 1, 25832}, kZone33{3072, 0, 1, 25833};

std::vector<LasPoint> square(std::int32_t west = 0) {
  std::vector<LasPoint> points;
  for (int i = 0; i < 25; ++i) points.push_back({west + 100 * (i % 5), 100 * (i / 5), 10 * i});
  return points;
}

class LidarSources : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// A square of points, with a CRS by GeoTIFF keys; without keys there is none.
  [[nodiscard]] std::string las(const std::string& name, const std::vector<Entry>& keys,
                                std::vector<LasPoint> points = square()) const {
    LasFileMaker las;
    las.points = std::move(points);
    std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(keys.size())};
    for (const Entry& key : keys) words.insert(words.end(), key.begin(), key.end());
    if (!keys.empty()) {
      las.records = {{34735, {reinterpret_cast<const char*>(words.data()), words.size() * 2}}};
    }
    write_file(file(name), las.bytes());
    return file(name);
  }
  [[nodiscard]] Outcome build(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "build");
    arguments.insert(arguments.end(), {"-o", file("t.ptin"), "--overwrite"});
    return run_ptin(arguments);
  }
  /// The build's refusal has all of these texts.
  void expect_refused(const std::vector<std::string>& arguments,
                      const std::vector<std::string>& texts) const {
    const Outcome outcome = build(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_NE(outcome.err.find(text), std::string::npos) << text << " in " << outcome.err;
    }
  }
  /// The warnings of a kind.
  [[nodiscard]] json warnings(const std::string& kind, std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = build(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    json found = json::array();
    if (outcome.status != 0) return found;
    const json report = json::parse(outcome.out);
    for (const json& w : report.at("warnings")) {
      if (w.at("kind") == kind) found.push_back(w);
    }
    return found;
  }
  /// The classes that the metadata say were kept.
  [[nodiscard]] json kept_classes(const std::string& source,
                                  std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), source);
    const Outcome outcome = build(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json info = answer_of({"info", file("t.ptin"), "--json"});
    return info.at("metadata").at("options").value("classes", json());
  }
  TestFolder folder_;
};

TEST_F(LidarSources, OfTwoCrssAreRefusedByTheNamesOfBoth) {
  const std::string a = las("a.las", {kProjected, kZone32}),
                    b = las("b.las", {kProjected, kZone33});
  expect_refused({a, b}, {"ETRS89 / UTM zone 32N (EPSG:25832)",
                          "ETRS89 / UTM zone 33N (EPSG:25833)", a, b, "--a-srs"});
  const std::string none = las("none.las", {});
  expect_refused({a, none}, {"EPSG:25832", "declares no CRS", a, none, "--a-srs"});
  expect_refused({none, a}, {"EPSG:25832", "declares no CRS", a, none, "--a-srs"});
}

TEST_F(LidarSources, OfTwoVerticalCrssAreRefusedByTheNamesOfBoth) {
  const std::string a = las("a.las", {kProjected, kZone32, {4096, 0, 1, 5783}});
  const std::string b = las("b.las", {kProjected, kZone32, {4096, 0, 1, 7837}});
  const std::string none = las("none.las", {kProjected, kZone32});
  expect_refused({a, b}, {"DHHN92 height (EPSG:5783)", "DHHN2016 height (EPSG:7837)", a, b});
  expect_refused({a, none}, {"DHHN92 height (EPSG:5783)", "no vertical CRS", a, none, "--a-srs"});
}

TEST_F(LidarSources, OfTwoUnitsAreRefusedByTheNamesOfBoth) {
  const std::string a = las("a.las", {kProjected, kZone32, {4099, 0, 1, 9003}});
  const std::string b = las("b.las", {kProjected, kZone32, {4099, 0, 1, 9001}});
  expect_refused({a, b}, {"US survey foot", "metre", a, b});
}

TEST_F(LidarSources, ThatAreEmptyNeedNoCrs) {
  const std::string a = las("a.las", {kProjected, kZone32});
  const std::string empty = las("empty.las", {}, {});
  for (const std::vector<std::string>& order :
       {std::vector{a, empty}, std::vector{empty, a}, std::vector{empty, a, empty}}) {
    const Outcome outcome = build(order);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("there is no point in"), std::string::npos) << outcome.err;
    EXPECT_EQ(answer_of({"info", file("t.ptin"), "--json"}).at("crs").at("code"), "EPSG:25832");
  }
  expect_refused({empty}, {"there is no point"});
}

TEST_F(LidarSources, WithoutACrsAreWarnedOfAsRastersAre) {
  const std::string a = las("a.las", {}), b = las("b.las", {}, square(1000));
  testing::RasterRecipe recipe;
  recipe.value = testing::hills;
  recipe.epsg = 0;
  testing::make_raster(file("r.tif"), recipe);
  for (const std::vector<std::string>& source :
       {std::vector{a, b}, std::vector<std::string>{file("r.tif")}}) {
    const json found = warnings("crs_none", source);
    ASSERT_EQ(found.size(), 1U) << source[0];
    EXPECT_EQ(found[0].at("file"), source[0]);
    EXPECT_NE(found[0].at("message").get<std::string>().find("--a-srs"), std::string::npos);
    std::vector<std::string> stated = source;
    stated.insert(stated.end(), {"--a-srs", "EPSG:25832"});
    EXPECT_EQ(warnings("crs_none", stated), json::array());
  }
  EXPECT_EQ(warnings("crs_none", {las("c.las", {kProjected, kZone32})}), json::array());
}

TEST_F(LidarSources, AreWarnedOfByTheFirstPointThatItIsAbout) {
  std::vector<LasPoint> points = square();
  points[7].cls = points[9].cls = 7;
  const Outcome outcome =
      build({las("a.las", {kProjected, kZone32}), las("b.las", {kProjected, kZone32}, points)});
  EXPECT_NE(outcome.err.find("b.las: a point is of class 7 or 18"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("(2 times, first point 8)"), std::string::npos) << outcome.err;
}

TEST_F(LidarSources, WithAPointFarFromAllOthersAreWarnedOfByTheFileThatItIsIn) {
  std::vector<LasPoint> points = square();
  points[7].x = 500000000;
  points[9].z = -999900;
  const std::string a = las("a.las", {kProjected, kZone32});
  const std::string b = las("b.las", {kProjected, kZone32}, points);
  for (const char* kind : {"far_points", "undeclared_nodata"}) {
    const json found = warnings(kind, {a, b});
    ASSERT_EQ(found.size(), 1U) << kind;
    EXPECT_EQ(found[0].at("file"), b);
  }
}

TEST_F(LidarSources, ThatAreNamedTwiceAreWarnedOf) {
  const std::string a = las("a.las", {kProjected, kZone32});
  std::filesystem::create_symlink(a, file("link.las"));
  testing::RasterRecipe recipe;
  recipe.value = testing::hills;
  testing::make_raster(file("r.tif"), recipe);
  for (const std::vector<std::string>& source :
       {std::vector<std::string>{a, a}, std::vector<std::string>{a, file("link.las")},
        std::vector<std::string>{file("r.tif"), file("r.tif")}}) {
    const json found = warnings("repeated_input", source);
    ASSERT_EQ(found.size(), 1U) << source[1];
    EXPECT_EQ(found[0].at("file"), source[1]);
  }
  std::filesystem::copy_file(a, file("copy.las"));
  EXPECT_EQ(warnings("repeated_input", {a, file("copy.las")}), json::array());
}

TEST_F(LidarSources, AreCutToRangesAndNamesOfClasses) {
  std::vector<LasPoint> points;
  for (int i = 0; i < 169; ++i) points.push_back({100 * (i % 13), 100 * (i / 13), i, i % 19});
  const std::string a = las("a.las", {kProjected, kZone32}, points);
  EXPECT_EQ(kept_classes(a, {"--class", "2,8-12"}), json({2, 8, 9, 10, 11, 12}));
  EXPECT_EQ(kept_classes(a, {"--class", "ground"}), json({2}));
  EXPECT_EQ(kept_classes(a, {"--class", "Ground,water", "--class", "5"}), json({2, 9, 5}));
  EXPECT_EQ(kept_classes(a, {"--class", "ground,vegetation"}), json({2, 3, 4, 5}));
  EXPECT_EQ(kept_classes(a, {"--class", "0-18,!7,18"}),
            json({0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}));
  const json not_noise = kept_classes(a, {"--class", "!7,18"});
  EXPECT_EQ(not_noise.size(), 254U);
  EXPECT_EQ(kept_classes(a, {"--class", "!noise"}), not_noise);
  EXPECT_EQ(kept_classes(a, {"--class", "!7", "--class", "!18"}), not_noise);
  EXPECT_EQ(run_ptin({"verify", file("t.ptin"), "--against", a}).status, 0);
  EXPECT_EQ(kept_classes(a, {}), json());
}

TEST_F(LidarSources, OfClassesThatAreNoneAreRefused) {
  const std::string a = las("a.las", {kProjected, kZone32});
  expect_refused({a, "--class", "256"}, {"--class", "256", "0 to 255"});
  expect_refused({a, "--class", "-1"}, {"--class", "-1"});
  expect_refused({a, "--class", "9-2"}, {"--class", "9-2"});
  expect_refused({a, "--class", "2-"}, {"--class", "2-"});
  expect_refused({a, "--class", "grund"}, {"--class", "grund", "ground"});
  expect_refused({a, "--class", ""}, {"--class"});
  expect_refused({a, "--class", "0-255,!0-255"}, {"--class", "leaves no class"});
}

TEST_F(LidarSources, MayBeAFolder) {
  std::filesystem::create_directories(file("tiles/deeper"));
  std::filesystem::create_directories(file("nothing"));
  const std::string b = las("tiles/b.LAS", {kProjected, kZone32}, square(1000));
  const std::string a = las("tiles/a.las", {kProjected, kZone32});
  std::ignore = las("tiles/deeper/c.las", {kProjected, kZone33});
  write_file(file("tiles/readme.txt"), "no points");
  const auto samples = [&](const std::vector<std::string>& source) {
    const Outcome outcome = build(source);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return testing::read_file(file("t.ptin"));
  };
  const std::string of_files = samples({a, b});
  EXPECT_EQ(samples({file("tiles")}), of_files);
  EXPECT_EQ(samples({file("tiles/")}), of_files);
  EXPECT_EQ(run_ptin({"verify", file("t.ptin"), "--against", file("tiles")}).status, 0);
  expect_refused({file("nothing")}, {"nothing", "this folder", ".las", ".laz"});
}

TEST_F(LidarSources, OnStandardInputAreRefused) {
  expect_refused({"-"}, {"standard input", "file"});
}

}  // namespace
}  // namespace ptin::tools
