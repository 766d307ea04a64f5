// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains without a surface, windows without one, and samples without a triangle: said, not hidden.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::run_ptin;
using testing::spawn_ptin_reading;
using testing::TestFolder;

using Arguments = std::vector<std::string>;

constexpr const char* kNoSurface = "has no surface, all of it is void";

class NoSurface : public ::testing::Test {
 protected:
  /// Builds a raster of 20 x 20 pixels of 30 m, void but for these pixels; returns what build said.
  Outcome build(const std::vector<std::array<int, 2>>& pixels, const Arguments& more = {}) {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = 20;
    recipe.nodata = -9999.0;
    recipe.value = [&](int column, int row) {
      const bool has_height =
          std::find(pixels.begin(), pixels.end(), std::array{column, row}) != pixels.end();
      return has_height ? 100.0 + column : -9999.0;
    };
    testing::make_raster(file("r.tif"), recipe);
    Arguments words = {"build", file("r.tif"), "-o", store(), "--overwrite"};
    words.insert(words.end(), more.begin(), more.end());
    return run_ptin(words);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string store() const { return file("r.ptin"); }
  /// What stderr says of a command that is done.
  static std::string warned(const Arguments& words) {
    const Outcome outcome = run_ptin(words);
    EXPECT_EQ(outcome.status, 0) << words[0] << outcome.err;
    return outcome.err;
  }
  static bool has(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }

 private:
  TestFolder folder_;
};

TEST_F_IN_RELEASE(NoSurface, BuildAndEveryQuestionWarn) {
  using Pixels = std::vector<std::array<int, 2>>;
  for (const Pixels& pixels : test::some_of({Pixels{}, Pixels{{5, 5}}, Pixels{{5, 5}, {12, 9}}})) {
    const Outcome built = build(pixels);
    EXPECT_EQ(built.status, 0);
    EXPECT_TRUE(has(built.err, store() + " " + kNoSurface)) << built.err;
    EXPECT_TRUE(has(built.err, pixels.empty() ? "no sample of the source has a height"
                                              : "no sample with a height has a triangle"));
    EXPECT_TRUE(has(built.err, "--nodata")) << "what to look at";
    const Arguments questions[] = {
        {"export", store(), "-o", file("a.tif"), "--overwrite"},
        {"export", store(), "-o", file("a.ply"), "--overwrite"},
        {"volume", store(), "--level", "5"},
        {"render", store(), "-o", file("a.png"), "--overwrite"},
        {"refine", store(), "-o", file("a.ply"), "--overwrite"},
        {"highest", store()},
        {"locate", store(), "500100", "3999800"},
        {"isoline", store(), "--level", "5", "-o", file("a.gpkg"), "--overwrite"},
        {"stream", store(), "-o", file("a.pts"), "--overwrite"}};
    for (Arguments words : questions) {
      EXPECT_TRUE(has(warned(words), "ptin: warning: " + store() + " " + kNoSurface)) << words[0];
      words.emplace_back("-q");
      EXPECT_EQ(warned(words), "") << words[0];
    }
  }
  build({});
  const Outcome lines = run_ptin({"isoline", store(), "-i", "10", "-o", file("b.gpkg")});
  EXPECT_EQ(lines.status, 0) << lines.err;
  EXPECT_TRUE(has(lines.err, "no surface crosses these levels; the layer is empty"));
}

TEST_F(NoSurface, OneTriangleIsASurface) {
  const Outcome built = build({{5, 5}, {6, 5}, {5, 6}});
  EXPECT_FALSE(has(built.err, "warning")) << built.err;
  EXPECT_FALSE(has(warned({"volume", store(), "--level", "5"}), "warning"));
  EXPECT_FALSE(has(warned({"export", store(), "-o", file("a.tif")}), "warning"));
}

TEST_F(NoSurface, AWindowOfVoidIsSaid) {
  build({{5, 5}, {6, 5}, {5, 6}});
  const Arguments window = {"--window", "500330", "3999450", "500500", "3999600"};
  const auto ask = [&](Arguments words) {
    words.insert(words.end(), window.begin(), window.end());
    return warned(words);
  };
  for (const char* what : {"height", "slope"}) {
    const std::string told =
        ask({"export", store(), "-o", file("a.tif"), "--what", what, "--overwrite"});
    EXPECT_TRUE(has(told, file("a.tif") + " has nodata alone")) << told;
  }
  EXPECT_TRUE(has(ask({"volume", store(), "--level", "5"}), "no surface lies in the region"));
  EXPECT_TRUE(has(ask({"render", store(), "-o", file("a.png")}), "shows no surface"));
}

/// Its pixel is nodata, so the certificate does not speak of it.
TEST_F(NoSurface, ExportSaysThatLoneSamplesAreVoid) {
  build({{5, 5}, {6, 5}, {5, 6}, {15, 15}});
  for (const char* name : {"a.tif", "a.ply"}) {
    const Outcome told = run_ptin({"export", store(), "-o", file(name)});
    EXPECT_TRUE(has(told.out, "within 0 at every sample (but lone ones)")) << told.out;
    EXPECT_TRUE(has(told.out, "1 sample of the source without a triangle, treated as void"));
  }
  EXPECT_EQ(answer_of({"export", store(), "-o", file("b.tif"), "--json"}).at("lone_samples"), 1);
  build({{5, 5}, {6, 5}, {5, 6}});
  const Outcome told = run_ptin({"export", store(), "-o", file("c.tif")});
  EXPECT_FALSE(has(told.out, "lone")) << told.out;
}

/// Points too far apart for --max-edge have no triangle, either.
TEST_F(NoSurface, PointsWithoutTrianglesWarnToo) {
  testing::write_file(file("p.csv"), "x,y,z\n0,0,1\n100,0,2\n0,100,3\n100,100,4\n50,40,5\n");
  const Outcome built =
      run_ptin({"build", file("p.csv"), "-o", store(), "--overwrite", "--max-edge", "1"});
  EXPECT_EQ(built.status, 0) << built.err;
  EXPECT_TRUE(has(built.err, kNoSurface)) << built.err;
  EXPECT_TRUE(has(warned({"highest", store()}), kNoSurface));
}

TEST_F(NoSurface, AnEmptyInputOfPointsIsSaid) {
  build({{5, 5}, {6, 5}, {5, 6}});
  testing::write_file(file("none.csv"), "x,y\n");
  testing::write_file(file("empty.txt"), "");
  for (const char* name : {"none.csv", "empty.txt"}) {
    const std::string told = warned({"locate", store(), "--points", file(name)});
    EXPECT_TRUE(has(told, file(name) + " held no point")) << told;
    EXPECT_EQ(warned({"locate", store(), "--points", file(name), "-q"}), "");
  }
  EXPECT_TRUE(has(warned({"sight", store(), "--pairs", file("empty.txt")}), "held no pair"));
  const Outcome piped = spawn_ptin_reading("", {"locate", store(), "--points", "-"});
  EXPECT_EQ(piped.status, 0);
  EXPECT_TRUE(has(piped.err, "standard input held no point")) << piped.err;
}

}  // namespace
}  // namespace ptin::tools
