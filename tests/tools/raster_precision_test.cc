// SPDX-License-Identifier: GPL-3.0-or-later
//
// How exact the heights of an exported raster are: samples bit for bit, and between them no farther
// from the terrain than the answer certifies.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::make_raster;
using testing::RasterRecipe;
using testing::TestFolder;

struct TypedRaster {
  explicit TypedRaster(const std::string& path) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str()));
    if (!data) throw std::runtime_error("cannot open " + path);
    GDALRasterBand& band = *data->GetRasterBand(1);
    type = GDALGetDataTypeName(band.GetRasterDataType());
    width = data->GetRasterXSize(), height = data->GetRasterYSize();
    EXPECT_EQ(data->GetGeoTransform(place), CE_None);
    values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, width, height, values.data(), width, height, GDT_Float64,
                            0, 0, nullptr),
              CE_None);
  }
  std::string type;
  int width = 0, height = 0;
  double place[6] = {};
  std::vector<double> values;
};

constexpr double kReckoning = 1e-10;  ///< What sums of doubles about 20 000 round.

class RasterPrecision : public ::testing::Test {
 protected:
  void build(const RasterRecipe& recipe) {
    make_raster(source_, recipe);
    expect_done({"build", source_, "-o", store_, "-q"});
  }
  json exported(const std::vector<std::string>& options) {
    std::vector<std::string> all = {"export", store_, "-o", made_, "--json", "--overwrite", "-q"};
    all.insert(all.end(), options.begin(), options.end());
    return answer_of(all);
  }
  /// Farthest that a written pixel is from the full TIN's height at its centre.
  [[nodiscard]] double worst_deviation() const {
    const TypedRaster made(made_);
    std::ostringstream centres;
    centres << std::setprecision(17) << "x,y\n";
    for (int j = 0; j < made.height; ++j) {
      for (int i = 0; i < made.width; ++i) {
        centres << made.place[0] + (i + 0.5) * made.place[1] << ','
                << made.place[3] + (j + 0.5) * made.place[5] << '\n';
      }
    }
    testing::write_file(folder_.file("centres.csv"), centres.str());
    const json points =
        answer_of({"locate", store_, "--points", folder_.file("centres.csv"), "--json"})
            .at("points");
    EXPECT_EQ(points.size(), made.values.size());
    double worst = 0;
    for (std::size_t i = 0; i < made.values.size(); ++i) {
      worst = std::max(worst, std::abs(made.values[i] - points[i].at("height").get<double>()));
    }
    return worst;
  }
  TestFolder folder_;
  std::string source_ = folder_.file("s.tif"), store_ = folder_.file("s.ptin"),
              made_ = folder_.file("m.tif");
};

/// Hills in hundredths, few of which are floats.
RasterRecipe hundredths(const std::function<double(double)>& height_of) {
  RasterRecipe recipe;
  recipe.type = "Float64";
  recipe.value = [height_of](int x, int y) {
    return height_of(std::round(testing::hills(x, y) * 100 + x * 3));
  };
  return recipe;
}

TEST_F(RasterPrecision, MultiplesOfAHundredthComeBackBitForBit) {
  build(hundredths([](double count) { return count * 0.01; }));
  const json told = exported({});
  const TypedRaster made(made_), source(source_);
  EXPECT_EQ(made.type, "Float64");
  EXPECT_EQ(made.values, source.values);
  EXPECT_EQ(told.at("exact"), true);
  EXPECT_EQ(told.at("certified_deviation"), 0.0);
}

// The double next to 20.43 may be another one than 2043 times a hundredth.
TEST_F(RasterPrecision, TwoDecimalsComeBackToTheirLastPlace) {
  build(hundredths([](double count) { return count / 100; }));
  const double certified = exported({}).at("certified_deviation");
  EXPECT_LT(certified, 1e-13);
  const TypedRaster made(made_), source(source_);
  ASSERT_EQ(made.values.size(), source.values.size());
  for (std::size_t i = 0; i < made.values.size(); ++i) {
    ASSERT_LE(std::abs(made.values[i] - source.values[i]), certified) << i;
  }
}

/// Whole numbers about 20 000, of which floats between hold nine binary places.
RasterRecipe whole_numbers() {
  RasterRecipe recipe;
  recipe.width = 25;
  recipe.height = 21;
  recipe.type = "Int16";
  recipe.value = [](int x, int y) { return 20000 + std::round(10 * testing::hills(x, y)); };
  return recipe;
}

TEST_F(RasterPrecision, WholeNumbersNeedNoDoubles) {
  build(whole_numbers());
  const json told = exported({});
  const TypedRaster made(made_), source(source_);
  EXPECT_EQ(made.type, "Float32");
  EXPECT_EQ(made.values, source.values);
  EXPECT_EQ(told.at("exact"), true);
}

// A pixel without a height rounds none, though floats do not hold the value that says so.
TEST_F(RasterPrecision, NodataRoundsNoHeight) {
  RasterRecipe recipe = whole_numbers();
  recipe.nodata = -9999.0;
  recipe.value = [](int x, int y) { return x > 10 && y > 10 ? -9999.0 : 20000.0 + x * y; };
  build(recipe);
  for (const char* nodata : {"-9999.9", "-1e300"}) {
    const json told = exported({"--nodata", nodata});
    EXPECT_EQ(told.at("exact"), true) << nodata;
    EXPECT_EQ(told.at("certified_deviation"), 0.0) << nodata;
  }
}

/// 1281/2048 of the source's: every centre is a double, and heights there have 26 places or more.
constexpr const char* kOtherPixel = "18.7646484375";

TEST_F(RasterPrecision, WhatFloatsRoundBetweenSamplesIsCertified) {
  build(whole_numbers());
  const json told = exported({"--pixel-size", kOtherPixel});
  EXPECT_EQ(TypedRaster(made_).type, "Float32");
  EXPECT_EQ(told.at("exact"), false);
  const double rounding = told.at("certified_deviation");
  EXPECT_EQ(told.at("certified_error"), rounding);
  EXPECT_LE(worst_deviation(), rounding + kReckoning);
  EXPECT_LE(rounding, 0x1p-10) << "half of a float's last place";
  EXPECT_GT(rounding, 0x1p-12);
}

TEST_F(RasterPrecision, CoarseHeightsAreCertifiedWithTheirRounding) {
  build(whole_numbers());
  const json told = exported({"--error", "200", "--pixel-size", kOtherPixel});
  const double worst = worst_deviation();
  EXPECT_LE(worst, told.at("certified_deviation").get<double>() + kReckoning);
  EXPECT_GT(worst, 1.0) << "a terrain that shows nothing";
}

}  // namespace
}  // namespace ptin::tools
