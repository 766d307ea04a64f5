// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin export of rasters: against the source, the triangles, and against itself cut otherwise.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"
#include "tests/tools/raster_reader.h"
#include "tests/tools/refusal.h"
#include "tools/export/pixel_grid.h"
#include "tools/export/raster_export.h"

namespace ptin::tools {
namespace {

using testing::built;
using testing::expect_done;
using testing::expect_refusal;
using testing::Outcome;
using testing::read_file;
using testing::read_raster;
using testing::ReadRaster;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

TEST(ExportRaster, RasterOfTheFullTinIsTheSource) {
  const TestFolder folder;
  for (const char* name : {"coast_257.tif", "mountains_257.tif"}) {
    const std::string file = built(folder, name);
    const ReadRaster source = read_raster(test_data(name));
    for (const char* format : {"GTiff", "COG"}) {
      expect_done(
          {"export", file, "--format", format, "-q", "--overwrite", "-o", folder.file("a.tif")});
      const ReadRaster made = read_raster(folder.file("a.tif"));
      ASSERT_EQ(made.width, source.width);
      ASSERT_EQ(made.height, source.height);
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(made.transform[i], source.transform[i], 1e-9 * std::abs(source.transform[i]));
      }
      std::size_t lone = 0;
      for (std::size_t i = 0; i < source.values.size(); ++i) {
        const bool is_void = source.values[i] == source.nodata;
        if (!is_void && made.values[i] == made.nodata) {
          ++lone;
        } else {
          ASSERT_EQ(made.values[i], is_void ? made.nodata : source.values[i]) << name << " " << i;
        }
      }
      EXPECT_LT(lone, 5U);
    }
  }
}

TEST(ExportRaster, TellsWhichSamplesChangeBetweenSurfaceAndVoid) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  expect_done({"export", file, "-q", "-o", folder.file("full.tif")});
  const ReadRaster full = read_raster(folder.file("full.tif"));
  std::size_t most = 0;
  for (const char* error : {"5", "40"}) {
    const Outcome outcome = run_ptin({"export", file, "--error", error, "--json", "--overwrite",
                                      "-o", folder.file("coarse.tif")});
    const auto answer = nlohmann::json::parse(outcome.out);
    const ReadRaster coarse = read_raster(folder.file("coarse.tif"));
    std::size_t to_void = 0, to_surface = 0;
    for (std::size_t i = 0; i < full.values.size(); ++i) {
      const bool before = full.values[i] != full.nodata, after = coarse.values[i] != coarse.nodata;
      to_void += before && !after ? 1 : 0;
      to_surface += !before && after ? 1 : 0;
    }
    EXPECT_EQ(answer["samples_made_void"], to_void);
    // A void sample on the border gets a height as a pixel, and has not changed its class.
    EXPECT_LE(answer["samples_made_surface"], to_surface);
    most = std::max(most, to_void);
  }
  EXPECT_GT(most, 0U);
}

TEST(ExportRaster, TakesSeveralCreationOptions) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const auto size = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"export", file, "-q", "-o", folder.file("a.tif")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.emplace_back("--overwrite");
    expect_done(arguments);
    return read_file(folder.file("a.tif")).size();
  };
  const std::size_t deflated = size({"--co", "COMPRESS=DEFLATE"});
  EXPECT_LT(deflated, size({"--co", "COMPRESS=NONE"}));
  EXPECT_NE(size({"--co", "COMPRESS=DEFLATE", "--co", "ZLEVEL=1"}), deflated);
}

TEST(ExportRaster, RefusesBlocksThatTheMemoryDoesNotHold) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const auto before = folder.names();
  for (const char* what : {"height", "slope"}) {
    expect_refusal(
        run_ptin({"export", file, "-q", "-o", folder.file("a.tif"), "--what", what, "--pixel-size",
                  "4", "--memory", "32M", "--co", "BLOCKXSIZE=4096", "--co", "BLOCKYSIZE=4096"}),
        7, "are there for it; give smaller blocks (--co BLOCKXSIZE=");
  }
  EXPECT_EQ(folder.names(), before);
}

TEST(ExportRaster, RasterDoesNotDependOnMemory) {
  const TestFolder folder;
  const Terrain terrain = Terrain::open(built(folder, "mountains_257.tif"));
  const StoreFacts& facts = terrain.store().facts();
  RasterRequest request =
      pixels_in(std::nullopt, {facts.map.step_x * 0.37, facts.map.step_y * 0.41}, facts);
  for (const PixelValue value : {PixelValue::kHeight, PixelValue::kSlope}) {
    std::string first;
    for (const std::uint64_t limit : {std::uint64_t{1} << 30, std::uint64_t{8'000'000}}) {
      request.limits.memory_bytes = limit;
      RasterTarget target{folder.file("a.tif"), true, false, {}, -9999.0, {}, {}, limit / 8};
      target.content.value = value;
      GDALAllRegister();
      static_cast<void>(export_raster(terrain, request, target, {}));
      const std::string bytes = read_file(target.path);
      if (first.empty()) first = bytes;
      EXPECT_TRUE(bytes == first);
    }
  }
}

/// Height of the TIN at a grid position by brute force: NAN where no surface triangle holds it.
double height_at(const Tin& tin, const StoreFacts& facts, long double x, long double y) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] == TriangleClass::kVoid) continue;
    std::array<long double, 3> w{};
    std::array<GridPoint, 3> p{};
    for (int i = 0; i < 3; ++i) p[i] = tin.position(tin.triangles[t].v[i]);
    for (int i = 0; i < 3; ++i) {
      const GridPoint a = p[next_corner(i)], b = p[previous_corner(i)];
      w[i] = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    }
    if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
    long double sum = 0;
    for (int i = 0; i < 3; ++i) {
      sum += w[i] * facts.heights.height(tin.vertices[tin.triangles[t].v[i]].height);
    }
    return static_cast<double>(sum / (w[0] + w[1] + w[2]));
  }
  return NAN;
}

TEST(ExportRaster, RasterInterpolatesTheTriangles) {
  const TestFolder folder;
  std::mt19937 random(7);
  for (const char* name : test::some_of({"coast_257.tif", "ground_points.csv"})) {
    const Terrain terrain = Terrain::open(built(folder, name));
    RefineRequest request;
    request.detail.tolerance = 5.0;
    const RefinedTin refined = terrain.refine(request);
    const StoreFacts& facts = terrain.store().facts();
    const GridBox& b = facts.bounds;
    const double pitch = std::max(b.max_x - b.min_x, b.max_y - b.min_y) / 61.3;
    RasterRequest pixels =
        pixels_in(std::nullopt, {facts.map.step_x * pitch, facts.map.step_y * pitch}, facts);
    pixels.detail = request.detail;
    std::vector<double> heights(static_cast<std::size_t>(pixels.pixels.pixels()));
    static_cast<void>(terrain.raster(pixels, heights));
    const SpotMap map(facts.map, facts.bounds);
    std::size_t surface = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const auto place = static_cast<std::int64_t>(i);
      const MapPoint centre =
          pixels.lattice.centre(pixels.pixels.column + place % pixels.pixels.width,
                                pixels.pixels.row + place / pixels.pixels.width);
      const Spot spot = *map.spot(centre);
      const double expected = height_at(refined.tin, facts, std::ldexp(1.0L, -kSpotBits) * spot.x,
                                        std::ldexp(1.0L, -kSpotBits) * spot.y);
      ASSERT_EQ(std::isnan(heights[i]), std::isnan(expected)) << name << " " << i;
      if (std::isnan(expected)) continue;
      ASSERT_NEAR(heights[i], expected, 1e-9) << name << " " << i;
      ++surface;
    }
    EXPECT_GT(surface, heights.size() / 8);
  }
}

TEST(ExportRaster, RastersOfWindowsAreCutsOfTheWhole) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const ReadRaster dem = read_raster(test_data("mountains_257.tif"));
  const std::string size = std::to_string(dem.transform[1] * 1.7);
  expect_done(
      {"export", file, "-q", "--error", "2", "--pixel-size", size, "-o", folder.file("a.tif")});
  const ReadRaster whole = read_raster(folder.file("a.tif"));
  const double x = dem.transform[0] + 80 * dem.transform[1];
  const double y = dem.transform[3] + 180 * dem.transform[5];
  expect_done({"export", file, "-q", "--error", "2", "--pixel-size", size, "-o",
               folder.file("b.tif"), "--window", std::to_string(x), std::to_string(y),
               std::to_string(x + 90 * dem.transform[1]),
               std::to_string(y - 100 * dem.transform[5])});
  const ReadRaster part = read_raster(folder.file("b.tif"));
  const double column = (part.transform[0] - whole.transform[0]) / whole.transform[1];
  const double row = (part.transform[3] - whole.transform[3]) / whole.transform[5];
  EXPECT_NEAR(column, std::round(column), 1e-6);
  EXPECT_NEAR(row, std::round(row), 1e-6);
  EXPECT_NEAR(part.width, 90 / 1.7, 1.0);
  for (int j = 0; j < part.height; ++j) {
    for (int i = 0; i < part.width; ++i) {
      const auto at =
          static_cast<std::size_t>((std::lround(row) + j) * whole.width + std::lround(column) + i);
      ASSERT_EQ(part.values[static_cast<std::size_t>(j * part.width + i)], whole.values[at]);
    }
  }
}

/// A terrain in degrees, at 59.984 degrees north; 0.032 degrees wide and high.
std::string terrain_in_degrees(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0005;
  recipe.pixel = 0.001;
  testing::make_raster(folder.file("degrees.tif"), recipe);
  expect_done({"build", folder.file("degrees.tif"), "-o", folder.file("degrees.ptin"), "-q"});
  return folder.file("degrees.ptin");
}

TEST(ExportRaster, TakesPixelSizesOverGround) {
  const TestFolder folder;
  const auto size = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "export", file, "--json", "--overwrite", "-o", folder.file("a.tif"), "--pixel-size"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto answer = testing::answer_of(arguments);
    const ReadRaster raster = read_raster(folder.file("a.tif"));
    EXPECT_EQ(answer.at("pixel_size").at(0), raster.transform[1]);
    EXPECT_EQ(answer.at("pixel_size").at(1), -raster.transform[5]);
    return std::array<double, 2>{raster.transform[1], -raster.transform[5]};
  };
  // A degree of latitude has 111 412 m there; one of longitude has 55 824 m, and 55 800 m at 60
  // degrees.
  const std::string degrees = terrain_in_degrees(folder);
  for (const char* text : {"90m", "90 m", "0.09km", "295.27559055118110ft"}) {
    EXPECT_NEAR(size(degrees, {text})[0], 90 / 55826.0, 5e-8) << text;
    EXPECT_NEAR(size(degrees, {text})[1], 90 / 111412.0, 5e-8) << text;
  }
  EXPECT_EQ(size(degrees, {"0.002", "90m"})[0], 0.002);
  const std::vector<std::string> north = {"90m", "--window", "9", "59.999", "10", "60.001"};
  EXPECT_NEAR(size(degrees, north)[0], 90 / 55800.0, 2e-8);
  EXPECT_GT(size(degrees, north)[0], size(degrees, {"90m"})[0]);
  EXPECT_EQ(size(built(folder, "mountains_257.tif"), {"90m"}), (std::array<double, 2>{90, 90}));
}

TEST(ExportRaster, RefusesPixelsThatDoNotFit) {
  const TestFolder folder;
  const auto refuse = [&](const std::string& file, const std::vector<std::string>& more,
                          const std::string& words) {
    std::vector<std::string> arguments = {"export",      file, "-q", "-o", folder.file("a.tif"),
                                          "--pixel-size"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_NE(outcome.err.find("ptin: --pixel-size: " + words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.tif")));
  };
  const std::string degrees = terrain_in_degrees(folder);
  refuse(degrees, {"90"}, "1 x 1 pixels of 90 x 90 map units fit the window of 0.032 x 0.032");
  refuse(degrees, {"0.001", "0.04"}, "33 x 1 pixels");
  refuse(degrees, {"0.01", "--window", "9.003", "59.97", "9.004", "60"}, "0 x 3 pixels");
  for (const char* text : {"90x", "m", "-3m", "0km", "nan", "1e999", "90 90", "90m2"}) {
    refuse(degrees, {text}, std::string("\"") + text + "\" is no size");
  }
  refuse(built(folder, "ground_points.csv"), {"9m"}, "the unit of the terrain's map is unknown");
}

}  // namespace
}  // namespace ptin::tools
