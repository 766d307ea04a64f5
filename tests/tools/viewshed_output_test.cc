// SPDX-License-Identifier: GPL-3.0-or-later
//
// What ptin viewshed writes, opened with GDAL: where the raster and the points lie, and what every
// value is.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::run_ptin;
using testing::TestFolder;

struct SeenRaster {
  explicit SeenRaster(const std::string& path) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str()));
    if (!data) throw std::runtime_error("cannot open " + path);
    EXPECT_EQ(data->GetRasterCount(), 1);
    EXPECT_EQ(data->GetGeoTransform(place.data()), CE_None);
    width = data->GetRasterXSize(), height = data->GetRasterYSize();
    GDALRasterBand* band = data->GetRasterBand(1);
    EXPECT_EQ(band->GetRasterDataType(), GDT_Byte);
    int has_nodata = 0;
    nodata = band->GetNoDataValue(&has_nodata);
    EXPECT_EQ(has_nodata, 1);
    if (const OGRSpatialReference* srs = data->GetSpatialRef()) {
      epsg = srs->GetAuthorityCode(nullptr) != nullptr ? srs->GetAuthorityCode(nullptr) : "";
    }
    values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    EXPECT_EQ(band->RasterIO(GF_Read, 0, 0, width, height, values.data(), width, height, GDT_Byte,
                             0, 0, nullptr),
              CE_None);
  }
  [[nodiscard]] int at(int column, int row) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
  [[nodiscard]] int count(int value) const {
    return static_cast<int>(std::count(values.begin(), values.end(), value));
  }
  std::array<double, 6> place{};
  int width = 0, height = 0;
  double nodata = -1;
  std::string epsg;
  std::vector<std::uint8_t> values;
};

struct SeenPoint {
  double height = 0;
  bool visible = false, certain = false;
};
using SeenPoints = std::map<std::pair<double, double>, SeenPoint>;

/// The only layer, whose fields and CRS are looked at.
SeenPoints points_in(const std::string& path) {
  GDALAllRegister();
  SeenPoints points;
  const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (!data) throw std::runtime_error("cannot open " + path);
  EXPECT_EQ(data->GetLayerCount(), 1);
  OGRLayer* layer = data->GetLayer(0);
  EXPECT_STREQ(layer->GetName(), "viewshed");
  EXPECT_EQ(layer->GetGeomType(), wkbPoint);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32611");
  const OGRFeatureDefn* fields = layer->GetLayerDefn();
  EXPECT_EQ(fields->GetFieldCount(), 3);
  for (const auto& feature : *layer) {
    const OGRPoint* p = feature->GetGeometryRef()->toPoint();
    const SeenPoint seen{feature->GetFieldAsDouble("height"),
                         feature->GetFieldAsInteger("visible") == 1,
                         feature->GetFieldAsInteger("certain") == 1};
    EXPECT_TRUE(points.try_emplace({p->getX(), p->getY()}, seen).second) << "twice";
  }
  return points;
}

// 33 x 33 samples 30 apart, the centre of the first at (500015, 3999985).
constexpr int kSamples = 33;
constexpr double kSpacing = 30;
constexpr int kEyeColumn = 5, kEyeRow = 10;
const char* const kEyeX = "500165";
const char* const kEyeY = "3999685";

/// Ground of 10 with a wall of 100 across column 16 and a pond without heights north of the eye.
bool is_pond(int column, int row) { return column > 2 && column < 8 && row > 3 && row < 7; }
double wall_and_pond(int column, int row) {
  return is_pond(column, row) ? -9999.0 : column == 16 ? 100.0 : 10.0;
}

class ViewshedOutput : public ::testing::Test {
 protected:
  void build(double (*value)(int, int), int epsg = 32611) {
    testing::RasterRecipe recipe;
    recipe.value = value;
    recipe.nodata = -9999.0;
    recipe.epsg = epsg;
    if (epsg == 4326) {
      recipe.pixel = 1.0 / 1200;  // the eye's sample at 10 E 45 N
      recipe.west = 10 - (kEyeColumn + 0.5) * recipe.pixel;
      recipe.north = 45 + (kEyeRow + 0.5) * recipe.pixel;
    }
    testing::make_raster(folder_.file("t.tif"), recipe);
    expect_done({"build", folder_.file("t.tif"), "-o", file_, "-q"});
  }
  json seen(const std::string& output, const std::string& height, const std::string& radius,
            const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"viewshed", file_, kEyeX, kEyeY, height, "--radius", radius};
    all.insert(all.end(), {"-o", folder_.file(output), "--json"});
    all.insert(all.end(), more.begin(), more.end());
    return answer_of(all);
  }
  TestFolder folder_;
  std::string file_ = folder_.file("t.ptin");
};

TEST_F(ViewshedOutput, RasterLiesOnTheSamplesAndTellsVisibleHiddenAndNoTargetApart) {
  build(wall_and_pond);
  const json told = seen("seen.tif", "5", "600");
  const SeenRaster raster(folder_.file("seen.tif"));
  constexpr int kReach = 20;  // pixels
  ASSERT_EQ(raster.width, 2 * kReach + 1);
  ASSERT_EQ(raster.height, 2 * kReach + 1);
  EXPECT_EQ(told.at("width"), raster.width);
  EXPECT_EQ(told.at("height"), raster.height);
  EXPECT_EQ(raster.place,
            (std::array<double, 6>{500165.0 - kReach * kSpacing - kSpacing / 2, kSpacing, 0,
                                   3999685.0 + kReach * kSpacing + kSpacing / 2, 0, -kSpacing}));
  EXPECT_EQ(raster.epsg, "32611");
  EXPECT_EQ(raster.nodata, 128);
  std::set<int> met;
  for (int j = 0; j < raster.height; ++j) {
    for (int i = 0; i < raster.width; ++i) {
      const int column = kEyeColumn + i - kReach, row = kEyeRow + j - kReach;
      const bool is_near =
          (i - kReach) * (i - kReach) + (j - kReach) * (j - kReach) <= kReach * kReach;
      const bool is_there = column >= 0 && row >= 0 && column < kSamples && row < kSamples;
      const int expected = !is_near || !is_there || is_pond(column, row) ? 128
                           : column <= 16                                ? 255
                                                                         : 0;
      EXPECT_EQ(raster.at(i, j), expected) << column << " " << row;
      met.insert(expected);
    }
  }
  EXPECT_EQ(met.size(), 3U);
  EXPECT_EQ(told.at("pixels"),
            (json{{"visible", raster.count(255)}, {"hidden", raster.count(0)}, {"undecided", 0}}));
}

TEST_F(ViewshedOutput, PixelsOfAnotherSizeHaveTheEyeInTheirMiddle) {
  build(wall_and_pond);
  seen("seen.tif", "5", "600", {"--pixel-size", "40"});
  const SeenRaster raster(folder_.file("seen.tif"));
  ASSERT_EQ(raster.width, 31);
  ASSERT_EQ(raster.height, 31);
  const double west = 500165.0 - 15.5 * 40, north = 3999685.0 + 15.5 * 40;
  const std::array<double, 6> expected = {west, 40, 0, north, 0, -40};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(raster.place[i], expected[i], 1e-6) << i;
  EXPECT_EQ(raster.at(15, 15), 255);
  EXPECT_EQ(raster.at(15 + 8, 15), 255);  // 320 m east: on the flank of the wall that looks at us
  EXPECT_EQ(raster.at(15 + 9, 15), 0);    // 360 m east: the foot of the other
}

TEST_F(ViewshedOutput, PixelsHaveSizesOverGround) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0005;
  recipe.pixel = 0.001;
  testing::make_raster(folder_.file("degrees.tif"), recipe);
  const std::string file = folder_.file("degrees.ptin");
  testing::expect_done({"build", folder_.file("degrees.tif"), "-o", file, "-q"});
  const auto run = [&](const char* size) {
    return run_ptin({"viewshed", file, "9.016", "59.985", "9", "--radius", "500", "--pixel-size",
                     size, "-o", folder_.file("seen.tif"), "--overwrite"});
  };
  EXPECT_EQ(run("90m").status, 0);
  const SeenRaster raster(folder_.file("seen.tif"));
  EXPECT_EQ(raster.width, 2 * 5 + 1);
  EXPECT_EQ(raster.height, 2 * 5 + 1);
  EXPECT_NEAR(raster.place[1], 90 / 55826.0, 5e-8);
  EXPECT_NEAR(-raster.place[5], 90 / 111412.0, 5e-8);
  for (const char* size : {"90", "600m", "0.6km"}) {
    const auto outcome = run(size);
    EXPECT_EQ(outcome.status, 2) << size;
    EXPECT_NE(outcome.err.find("are larger than the radius"), std::string::npos) << outcome.err;
  }
  EXPECT_NE(run("90x").err.find("ptin: --pixel-size: \"90x\" is no size"), std::string::npos);
}

TEST_F(ViewshedOutput, LayerHasTheVerticesWithWhatIsSeenOfThem) {
  build(wall_and_pond);
  for (const char* name : {"seen.gpkg", "seen.fgb"}) {
    const json told = seen(name, "5", "600");
    const SeenPoints points = points_in(folder_.file(name));
    std::size_t expected = 0;
    for (int row = 0; row < kSamples; ++row) {
      for (int column = 0; column < kSamples; ++column) {
        const double dx = kSpacing * (column - kEyeColumn), dy = kSpacing * (kEyeRow - row);
        const auto found = points.find({500165.0 + dx, 3999685.0 + dy});
        const bool is_target = dx * dx + dy * dy <= 600.0 * 600.0 && !is_pond(column, row);
        ASSERT_EQ(found != points.end(), is_target) << column << " " << row;
        if (!is_target) continue;
        ++expected;
        EXPECT_EQ(found->second.height, wall_and_pond(column, row));
        EXPECT_EQ(found->second.visible, column <= 16) << column << " " << row;
        EXPECT_TRUE(found->second.certain);
      }
    }
    EXPECT_EQ(points.size(), expected) << name;
    EXPECT_EQ(told.at("vertices").at("undecided"), 0);
  }
}

TEST_F(ViewshedOutput, AtAnErrorSaysWhatIsCertainAndIsRightThere) {
  build(testing::hills);
  const std::vector<std::string> targets = {"--target-height", "20"};
  seen("exact.tif", "10", "800", targets);
  const json told = seen("coarse.tif", "10", "800", {"--target-height", "20", "--error", "8"});
  const SeenRaster exact(folder_.file("exact.tif")), coarse(folder_.file("coarse.tif"));
  ASSERT_EQ(coarse.values.size(), exact.values.size());
  EXPECT_EQ(coarse.place, exact.place);
  for (std::size_t i = 0; i < exact.values.size(); ++i) {
    const int value = coarse.values[i];
    EXPECT_EQ(value == 128, exact.values[i] == 128) << i;
    if (value == 255 || value == 0) {
      EXPECT_EQ(value, exact.values[i]) << i;
    }
  }
  EXPECT_EQ(exact.count(64) + exact.count(192), 0);
  const int undecided = coarse.count(64) + coarse.count(192);
  EXPECT_EQ(told.at("pixels"), (json{{"visible", coarse.count(255)},
                                     {"hidden", coarse.count(0)},
                                     {"undecided", undecided}}));
  int all = 0;
  for (const int value : {0, 64, 128, 192, 255}) {
    EXPECT_GT(coarse.count(value), 0) << value << ": a terrain that shows nothing";
    all += coarse.count(value);
  }
  EXPECT_EQ(all, static_cast<int>(coarse.values.size())) << "a value that means nothing";
}

TEST_F(ViewshedOutput, LayerAtAnErrorIsRightWhereItIsCertain) {
  build(testing::hills);
  seen("exact.gpkg", "10", "800", {"--target-height", "20"});
  const json told = seen("coarse.gpkg", "10", "800", {"--target-height", "20", "--error", "8"});
  const SeenPoints exact = points_in(folder_.file("exact.gpkg"));
  const SeenPoints coarse = points_in(folder_.file("coarse.gpkg"));
  EXPECT_LT(coarse.size(), exact.size());
  int certain = 0, undecided = 0;
  for (const auto& [place, point] : coarse) {
    const auto found = exact.find(place);
    ASSERT_NE(found, exact.end()) << "a vertex is a sample";
    EXPECT_EQ(point.height, found->second.height);
    if (point.certain) {
      EXPECT_EQ(point.visible, found->second.visible);
    }
    ++(point.certain ? certain : undecided);
  }
  EXPECT_GT(certain, 0);
  EXPECT_GT(undecided, 0);
  EXPECT_EQ(told.at("vertices").at("undecided"), undecided);
}

TEST_F(ViewshedOutput, InDegreesTakesItsRadiusInMetres) {
  build(wall_and_pond, 4326);
  expect_done({"viewshed", file_, "10", "45", "5", "--radius", "1000", "--curvature", "0", "-o",
               folder_.file("seen.tif")});
  const SeenRaster raster(folder_.file("seen.tif"));
  // At 45 N on WGS 84 a degree is 111 131.777 m of the meridian and 78 846.835 m of the parallel.
  constexpr double kNorthPixel = 111131.777 / 1200, kEastPixel = 78846.835 / 1200;
  const int reach_x = static_cast<int>(1000 / kEastPixel),
            reach_y = static_cast<int>(1000 / kNorthPixel);
  ASSERT_EQ(raster.width, 2 * reach_x + 1);
  ASSERT_EQ(raster.height, 2 * reach_y + 1);
  const std::array<double, 6> place = {10 - (reach_x + 0.5) / 1200, 1.0 / 1200, 0,
                                       45 + (reach_y + 0.5) / 1200, 0,          -1.0 / 1200};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(raster.place[i], place[i], 1e-11) << i;
  EXPECT_EQ(raster.epsg, "4326");
  for (int j = 0; j < raster.height; ++j) {
    for (int i = 0; i < raster.width; ++i) {
      const double distance = std::hypot((i - reach_x) * kEastPixel, (j - reach_y) * kNorthPixel);
      ASSERT_GT(std::abs(distance - 1000), 0.01) << "too near to tell";
      const int column = kEyeColumn + i - reach_x, row = kEyeRow + j - reach_y;
      const bool is_there = column >= 0 && row >= 0 && column < kSamples && row < kSamples;
      const int expected = distance > 1000 || !is_there || is_pond(column, row) ? 128
                           : column <= 16                                       ? 255
                                                                                : 0;
      EXPECT_EQ(raster.at(i, j), expected) << column << " " << row;
    }
  }
}

TEST_F(ViewshedOutput, TakesAnAbsoluteHeightAlsoAboveAVoid) {
  build(wall_and_pond);
  const json above = seen("above.tif", "60", "800");
  const json absolute = seen("absolute.tif", "70", "800", {"--absolute"});
  EXPECT_EQ(above.at("eye_height"), 70.0);
  EXPECT_EQ(absolute.at("eye_height"), 70.0);
  EXPECT_EQ(SeenRaster(folder_.file("above.tif")).values,
            SeenRaster(folder_.file("absolute.tif")).values);
  const std::vector<std::string> on_the_pond = {
      "viewshed", file_, kEyeX, "3999835", "60", "--radius", "300", "-o", folder_.file("pond.tif")};
  EXPECT_EQ(run_ptin(on_the_pond).status, 2);
  std::vector<std::string> over_it = on_the_pond;
  over_it.insert(over_it.end(), {"--absolute", "--json"});
  EXPECT_EQ(answer_of(over_it).at("eye_height"), 60.0);
}

// The grid of points is as fine as their digits, which is no size of a pixel.
TEST(ViewshedPixels, HaveToBeChosenWhereTheTerrainIsNoRaster) {
  const TestFolder folder;
  const std::string points = testing::built(folder, "ground_points.csv");
  testing::write_file(folder.file("m.obj"),
                      "v 0 0 1\nv 100 0 2\nv 100 100 3\nv 0 100 4\nf 1 2 3\nf 1 3 4\n");
  const std::string tin = folder.file("m.ptin");
  expect_done({"build", folder.file("m.obj"), "-o", tin, "-q"});
  const json bounds = answer_of({"info", points, "--json"}).at("bounds");
  const auto middle = [&](const char* low, const char* high) {
    return std::to_string((bounds.at(low).get<double>() + bounds.at(high).get<double>()) / 2);
  };
  const auto before = folder.names();
  for (const auto& [terrain, x, y] :
       {std::array<std::string, 3>{points, middle("min_x", "max_x"), middle("min_y", "max_y")},
        {tin, "40", "50"}}) {
    std::vector<std::string> asked = {
        "viewshed", terrain, x, y, "5", "--radius", "20", "-o", folder.file("seen.tif"), "-q"};
    const testing::Outcome outcome = run_ptin(asked);
    EXPECT_EQ(outcome.status, 2) << terrain;
    EXPECT_NE(outcome.err.find("--pixel-size"), std::string::npos) << outcome.err;
    EXPECT_EQ(folder.names(), before);
    asked.insert(asked.end(), {"--pixel-size", "2"});
    expect_done(asked);
    const SeenRaster raster(folder.file("seen.tif"));
    EXPECT_EQ(raster.width, 21);
    EXPECT_GT(raster.count(255), 0);
    std::filesystem::remove(folder.file("seen.tif"));
  }
}

}  // namespace
}  // namespace ptin::tools
