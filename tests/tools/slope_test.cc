// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slopes, aspects and hillshades of export: against gdaldem, and against the triangles themselves.
#include "tools/slope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "engine/query/questions.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::built;
using testing::expect_done;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

TEST(Slope, FallsTowardsItsAspect) {
  EXPECT_EQ(aspect_of({0, 0}), std::nullopt);
  EXPECT_EQ(aspect_of({0, -1}), 0.0);
  EXPECT_EQ(aspect_of({-1, 0}), 90.0);
  EXPECT_EQ(aspect_of({0, 1}), 180.0);
  EXPECT_EQ(aspect_of({1, 0}), 270.0);
  EXPECT_NEAR(*aspect_of({1, -1}), 315.0, 1e-12);
  EXPECT_EQ(aspect_of({1e-300, -1}), 0.0) << "never 360";
  EXPECT_NEAR(degrees_of({3, 4}), 78.690067525979787, 1e-12);
  EXPECT_EQ(percent_of({3, 4}), 500.0);
}

TEST(Slope, IsBrightestTowardsTheLight) {
  EXPECT_NEAR(Light(315, 45).on({0, 0}), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(Light(90, 30).on({-std::sqrt(3.0), 0}), 1.0, 1e-15) << "falls to the east";
  EXPECT_LT(Light(90, 30).on({std::sqrt(3.0), 0}), 0.0);
  EXPECT_EQ(grey_of(-0.5), 1.0);
  EXPECT_EQ(grey_of(1.0), 255.0);
}

struct Read {
  int width = 0, height = 0;
  GDALDataType type = GDT_Unknown;
  double nodata = 0.0;
  std::string unit;
  std::vector<double> values;
};

Read read(GDALDataset* dataset) {
  Read raster;
  if (dataset == nullptr) return raster;
  GDALRasterBand* band = dataset->GetRasterBand(1);
  raster.width = dataset->GetRasterXSize();
  raster.height = dataset->GetRasterYSize();
  raster.type = band->GetRasterDataType();
  raster.nodata = band->GetNoDataValue();
  raster.unit = band->GetUnitType();
  raster.values.resize(static_cast<std::size_t>(raster.width) * raster.height);
  EXPECT_EQ(band->RasterIO(GF_Read, 0, 0, raster.width, raster.height, raster.values.data(),
                           raster.width, raster.height, GDT_Float64, 0, 0),
            CE_None);
  return raster;
}

Read read(const std::string& path) {
  GDALAllRegister();
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
  EXPECT_TRUE(dataset) << path;
  return read(dataset.get());
}

/// What `gdaldem WHAT MORE...` makes of a raster.
Read gdaldem(const std::string& path, const char* what, const std::vector<std::string>& more = {}) {
  GDALAllRegister();
  const GDALDatasetUniquePtr source(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
  CPLStringList arguments;
  for (const char* argument : {"-of", "MEM"}) arguments.AddString(argument);
  for (const std::string& argument : more) arguments.AddString(argument.c_str());
  GDALDEMProcessingOptions* options = GDALDEMProcessingOptionsNew(arguments.List(), nullptr);
  const GDALDatasetUniquePtr made(GDALDataset::FromHandle(
      GDALDEMProcessing("", GDALDataset::ToHandle(source.get()), what, nullptr, options, nullptr)));
  GDALDEMProcessingOptionsFree(options);
  return read(made.get());
}

class SlopeExport : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string store_of(const testing::RasterRecipe& recipe) const {
    testing::make_raster(file("dem.tif"), recipe);
    expect_done({"build", file("dem.tif"), "-o", file("dem.ptin"), "-q", "--overwrite"});
    return file("dem.ptin");
  }
  [[nodiscard]] Read exported(const std::string& store,
                              const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"export",      store, "-q",
                                          "--overwrite", "-o",  file("o.tif")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_done(arguments);
    return read(file("o.tif"));
  }
  TestFolder folder_;
};

/// The largest difference where both have a value, over pixels that are not on the border; `around`
/// is the length of the circle that values lie on.
double largest_difference(const Read& a, const Read& b, double around = INFINITY) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  double largest = 0.0;
  for (int y = 1; y + 1 < a.height; ++y) {
    for (int x = 1; x + 1 < a.width; ++x) {
      const auto at = static_cast<std::size_t>(y * a.width + x);
      EXPECT_EQ(a.values[at] == a.nodata, b.values[at] == b.nodata) << x << " " << y;
      const double apart = std::abs(a.values[at] - b.values[at]);
      largest = std::max(largest, std::min(apart, std::abs(around - apart)));
    }
  }
  return largest;
}

TEST_F(SlopeExport, OfAPlaneIsWhatGdaldemSays) {
  for (const std::array<int, 2> rise : {std::array{7, 3}, {0, -4}, {-6, 5}, {0, 0}}) {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = 17;
    recipe.columns_go_west = rise[0] < 0;
    recipe.value = [&](int column, int row) { return 500.0 + rise[0] * column + rise[1] * row; };
    const std::string store = store_of(recipe);
    // Ours is north-up whatever the source is; so is what gdaldem gets.
    expect_done({"export", store, "-q", "--overwrite", "-o", file("up.tif")});
    const std::string dem = file("up.tif");
    EXPECT_LT(largest_difference(exported(store, {"--what", "slope"}), gdaldem(dem, "slope")),
              2e-5);
    EXPECT_LT(largest_difference(exported(store, {"--what", "slope", "--slope-unit", "percent"}),
                                 gdaldem(dem, "slope", {"-p"})),
              2e-5);
    EXPECT_LT(
        largest_difference(exported(store, {"--what", "aspect"}), gdaldem(dem, "aspect"), 360),
        5e-5);
    EXPECT_EQ(
        largest_difference(exported(store, {"--what", "hillshade"}), gdaldem(dem, "hillshade")),
        0.0);
    EXPECT_EQ(largest_difference(
                  exported(store, {"--what", "hillshade", "--azimuth", "100", "--altitude", "30"}),
                  gdaldem(dem, "hillshade", {"-az", "100", "-alt", "30"})),
              0.0);
  }
}

TEST_F(SlopeExport, OfMountainsIsNearWhatGdaldemSays) {
  const std::string store = built(folder_, "mountains_257.tif");
  const auto mean_difference = [&](const char* what) {
    const Read ours = exported(store, {"--what", what});
    const Read theirs = gdaldem(test_data("mountains_257.tif"), what);
    double sum = 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < ours.values.size(); ++i) {
      if (ours.values[i] == ours.nodata || theirs.values[i] == theirs.nodata) continue;
      const double apart = std::abs(ours.values[i] - theirs.values[i]);
      sum += what == std::string("aspect") ? std::min(apart, 360 - apart) : apart;
      ++counted;
    }
    EXPECT_GT(counted, ours.values.size() / 2);
    return sum / static_cast<double>(counted);
  };
  EXPECT_LT(mean_difference("slope"), 0.8);
  EXPECT_LT(mean_difference("aspect"), 3.0);
  EXPECT_LT(mean_difference("hillshade"), 3.0);
}

/// What a point of a TIN has, from every closed surface triangle that holds it: by brute force, in
/// map coordinates, for a plane in one unit with the heights.
struct Normal {
  long double x = 0, y = 0, z = 0;
};
Normal normal_at(const Tin& tin, const StoreFacts& facts, long double x, long double y) {
  Normal sum;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] == TriangleClass::kVoid) continue;
    std::array<std::array<long double, 3>, 3> p{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = tin.vertices[tin.triangles[t].v[i]];
      const MapPoint at = facts.map.to_map(v.position.x, v.position.y);
      p[i] = {at.x, at.y, facts.heights.height(v.height)};
    }
    bool holds = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& a = p[i];
      const auto& b = p[(i + 1) % 3];
      holds = holds && (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0;
    }
    if (!holds) continue;
    std::array<long double, 3> u{}, v{};
    for (std::size_t i = 0; i < 3; ++i) u[i] = p[1][i] - p[0][i], v[i] = p[2][i] - p[0][i];
    sum.x += u[1] * v[2] - u[2] * v[1];
    sum.y += u[2] * v[0] - u[0] * v[2];
    sum.z += u[0] * v[1] - u[1] * v[0];
  }
  return sum;
}

TEST_F(SlopeExport, IsOfTheTrianglesThatHoldTheCentre) {
  testing::RasterRecipe recipe;
  recipe.width = recipe.height = 24;
  recipe.pixel = 32.0;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    return column > 14 && row < 6 ? -9999.0 : std::round(4 * testing::hills(column, row));
  };
  const std::string store = store_of(recipe);
  for (const std::vector<std::string>& level : {std::vector<std::string>{}, {"--error", "8"}}) {
    for (const char* size :
         test::some_of({"32", "16", "20"})) {  // on vertices and edges; also within
      std::vector<std::string> more = {"--what", "slope", "--pixel-size", size};
      more.insert(more.end(), level.begin(), level.end());
      const Read slopes = exported(store, more);
      more[1] = "aspect";
      const Read aspects = exported(store, more);
      const Terrain terrain = Terrain::open(store);
      RefineRequest request;
      if (!level.empty()) request.detail.tolerance = 8.0;
      const RefinedTin refined = terrain.refine(request);
      const StoreFacts& facts = terrain.store().facts();
      const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
      std::size_t with_slope = 0;
      for (std::size_t i = 0; i < slopes.values.size(); ++i) {
        const auto column = static_cast<int>(i) % slopes.width;
        const auto row = slopes.height - 1 - static_cast<int>(i) / slopes.width;
        const Normal n = normal_at(refined.tin, facts, low.x + column * std::stold(size),
                                   low.y + row * std::stold(size));
        ASSERT_EQ(slopes.values[i] == slopes.nodata, n.z == 0) << i;
        if (n.z == 0) continue;
        const double rise = static_cast<double>(std::hypot(n.x, n.y) / n.z);
        ASSERT_NEAR(slopes.values[i], std::atan(rise) * 180 / M_PI, 1e-4) << size << " " << i;
        ASSERT_EQ(aspects.values[i] == aspects.nodata, rise == 0);
        if (rise < 1e-3) continue;
        const double towards = static_cast<double>(std::atan2(n.x, n.y)) * 180 / M_PI;
        ASSERT_NEAR(std::remainder(aspects.values[i] - towards, 360), 0, 1e-3);
        ++with_slope;
      }
      EXPECT_GT(with_slope, 300U);
    }
  }
}

TEST_F(SlopeExport, IsOverGroundInDegreesAndFeet) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0005;
  recipe.pixel = 0.001;
  recipe.value = [](int column, int) { return 20.0 * column; };
  Read slopes = exported(store_of(recipe), {"--what", "slope", "--slope-unit", "percent"});
  EXPECT_EQ(slopes.unit, "percent");
  // A degree of longitude has 55 800 m at 60 degrees north, and 55 854 m 0.032 degrees south of it.
  EXPECT_NEAR(slopes.values[5], 100 * 20 / 55.800, 1e-2);
  EXPECT_NEAR(slopes.values[32 * 33 + 5], 100 * 20 / 55.854, 1e-2);
  recipe.value = [](int column, int row) { return 10.0 * column - 10.0 * row; };
  const Read aspects = exported(store_of(recipe), {"--what", "aspect"});
  // It falls to the south-west, the steeper to the west since a degree is shorter there.
  EXPECT_NEAR(aspects.values[5], 180 + std::atan(111.412 / 55.800) * 180 / M_PI, 1e-2);

  recipe = {};
  recipe.unit = "ft";
  recipe.value = [](int column, int) { return 100.0 * column; };
  slopes = exported(store_of(recipe), {"--what", "slope", "--slope-unit", "percent"});
  EXPECT_NEAR(slopes.values[40], 100 * 100 * 0.3048 / 30, 1e-4);
}

TEST_F(SlopeExport, DoesNotDependOnMemoryOrWindows) {
  const std::string store = built(folder_, "coast_257.tif");
  for (const char* what : {"slope", "aspect", "hillshade"}) {
    const Read whole = exported(store, {"--what", what});
    const std::string bytes = testing::read_file(file("o.tif"));
    static_cast<void>(exported(store, {"--what", what, "--memory", "32M"}));
    EXPECT_EQ(testing::read_file(file("o.tif")) == bytes, true) << what;
    const auto bounds = answer_of({"info", store, "--json"}).at("bounds");
    const double west = bounds.at("min_x"), north = bounds.at("max_y");
    const double step = (bounds.at("max_x").get<double>() - west) / 256;
    const auto text = [](double v) { return std::to_string(v); };
    const Read part = exported(
        store, {"--what", what, "--window", text(west + 50.2 * step), text(north - 99.8 * step),
                text(west + 120.4 * step), text(north - 30.1 * step)});
    for (int y = 0; y < part.height; ++y) {
      for (int x = 0; x < part.width; ++x) {
        ASSERT_EQ(part.values[static_cast<std::size_t>(y * part.width + x)],
                  whole.values[static_cast<std::size_t>((y + 31) * whole.width + x + 51)]);
      }
    }
  }
}

TEST_F(SlopeExport, HasSensiblePixels) {
  const std::string store = built(folder_, "coast_257.tif");
  EXPECT_EQ(exported(store, {"--what", "slope"}).type, GDT_Float32);
  EXPECT_EQ(exported(store, {"--what", "slope"}).nodata, -9999.0);
  EXPECT_EQ(exported(store, {"--what", "slope"}).unit, "degree");
  EXPECT_EQ(exported(store, {"--what", "aspect"}).type, GDT_Float32);
  for (const char* format : {"GTiff", "COG"}) {
    const Read shade = exported(store, {"--what", "hillshade", "--format", format});
    EXPECT_EQ(shade.type, GDT_Byte);
    EXPECT_EQ(shade.nodata, 0.0);
    EXPECT_TRUE(std::find(shade.values.begin(), shade.values.end(), 181.0) != shade.values.end())
        << "flat water";
  }
}

TEST_F(SlopeExport, CertifiesHeightsAlone) {
  const std::string store = built(folder_, "mountains_257.tif");
  const auto ask = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"export",      store, "--json",
                                          "--overwrite", "-o",  file("o.tif")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments);
  };
  const auto full = ask({"--what", "slope"});
  EXPECT_EQ(full.at("what"), "slope");
  EXPECT_EQ(full.at("slope_unit"), "degree");
  EXPECT_TRUE(full.at("exact"));
  const auto coarse = ask({"--what", "slope", "--error", "5"});
  EXPECT_TRUE(coarse.at("certified_error").is_null());
  EXPECT_TRUE(coarse.at("certified_deviation").is_null());
  EXPECT_FALSE(coarse.at("exact"));
  EXPECT_EQ(ask({"--error", "5"}).at("what"), "height");
  EXPECT_LE(ask({"--error", "5"}).at("certified_error"), 5.0 + 1e-3);
  const auto told = run_ptin(
      {"export", store, "--error", "5", "--what", "aspect", "--overwrite", "-o", file("o.tif")});
  EXPECT_NE(told.out.find("aspect of a TIN that is within"), std::string::npos) << told.out;
  const auto whole =
      run_ptin({"export", store, "--what", "slope", "--overwrite", "-o", file("o.tif")});
  EXPECT_NE(whole.out.find("; slope of the full TIN\n"), std::string::npos) << whole.out;
}

TEST_F(SlopeExport, GivesTrianglesTheirFields) {
  testing::RasterRecipe recipe;
  recipe.width = recipe.height = 12;
  recipe.value = [](int column, int row) {
    return column < 4 ? 0.0 : std::round(testing::hills(column, row));
  };
  const std::string store = store_of(recipe);
  GDALAllRegister();
  for (const char* name : {"a.gpkg", "a.fgb"}) {
    for (const bool percent : {false, true}) {
      std::vector<std::string> arguments = {"export", store, "-q", "--overwrite", "-o", file(name)};
      if (percent) arguments.insert(arguments.end(), {"--slope-unit", "percent"});
      expect_done(arguments);
      const GDALDatasetUniquePtr dataset(GDALDataset::Open(file(name).c_str(), GDAL_OF_VECTOR));
      ASSERT_TRUE(dataset);
      std::size_t flat = 0, steep = 0;
      for (const auto& feature : *dataset->GetLayer(0)) {
        const OGRLinearRing* ring = feature->GetGeometryRef()->toPolygon()->getExteriorRing();
        const double ux = ring->getX(1) - ring->getX(0), uy = ring->getY(1) - ring->getY(0);
        const double vx = ring->getX(2) - ring->getX(0), vy = ring->getY(2) - ring->getY(0);
        const double uz = ring->getZ(1) - ring->getZ(0), vz = ring->getZ(2) - ring->getZ(0);
        const double area = ux * vy - uy * vx;
        const Slope slope{(uz * vy - vz * uy) / area, (ux * vz - vx * uz) / area};
        const double expected = percent ? percent_of(slope) : degrees_of(slope);
        EXPECT_NEAR(feature->GetFieldAsDouble("slope"), expected, 1e-9);
        const bool is_flat = feature->IsFieldNull(feature->GetFieldIndex("aspect")) != 0 ||
                             !feature->IsFieldSet(feature->GetFieldIndex("aspect"));
        EXPECT_EQ(is_flat, uz == 0 && vz == 0);
        (is_flat ? flat : steep) += 1;
        if (is_flat) continue;
        EXPECT_NEAR(std::remainder(feature->GetFieldAsDouble("aspect") - *aspect_of(slope), 360), 0,
                    1e-9);
      }
      EXPECT_GT(flat, 20U);
      EXPECT_GT(steep, 50U);
    }
  }
}

TEST_F(SlopeExport, RefusesOptionsThatSayNothing) {
  const std::string store = built(folder_, "ground_points.csv");
  const auto fails = [&](std::vector<std::string> arguments, const char* words) {
    arguments.insert(arguments.begin(), {"export", store, "-q"});
    const testing::Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  const std::string tif = file("a.tif");
  fails({"-o", file("a.ply"), "--what", "slope"}, "--what: is for rasters");
  fails({"-o", file("a.gpkg"), "--what", "aspect"}, "fields slope and aspect");
  fails({"-o", tif, "--pixel-size", "5", "--what", "colour"}, "colour");
  fails({"-o", tif, "--pixel-size", "5", "--slope-unit", "percent"}, "--slope-unit: is for");
  fails({"-o", file("a.ply"), "--slope-unit", "percent"}, "--slope-unit: is for");
  fails({"-o", tif, "--pixel-size", "5", "--what", "slope", "--azimuth", "3"}, "--azimuth: tells");
  fails({"-o", tif, "--pixel-size", "5", "--altitude", "3"}, "--altitude: tells");
  fails({"-o", tif, "--pixel-size", "5", "--what", "hillshade", "--altitude", "91"},
        "--altitude: must be a number from 0 to 90; 91 is none");
  fails({"-o", tif, "--pixel-size", "5", "--what", "hillshade", "--azimuth", "nan"}, "--azimuth");
  fails({"-o", tif, "--pixel-size", "5", "--what", "slope", "--nodata", "0"}, "--nodata: is for");
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"ground_points.csv.ptin"});
}

}  // namespace
}  // namespace ptin::tools
