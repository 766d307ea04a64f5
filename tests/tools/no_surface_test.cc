// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains without a surface, windows without one, and samples without a triangle: said, not hidden.
#include "tests/tools/no_surface.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::kNoSurface;
using testing::NoSurface;
using testing::Outcome;
using testing::run_ptin;
using testing::spawn_ptin_reading;

using Arguments = testing::NoSurface::Arguments;

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
