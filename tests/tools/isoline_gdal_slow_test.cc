// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines beside those of gdal_contour (the function behind that program), on real DEMs.
//
// Both interpolate linearly along the sides of a cell of four samples, so on the sides they cut in
// the same places. Inside a cell gdal_contour joins two cuts straight, and four (a saddle) by the
// mean of the corners; a TIN has the cell's diagonal, and with it one cut more, or at a saddle
// another pairing. So the level sets are the same up to what happens inside single cells, and no
// point of one is farther from the other than a cell's diagonal. This test compares all cuts on
// sides, both ways. Levels are taken between heights, since gdal_contour adds 1e-6 to samples that
// near to a level; sides beside cells with a missing corner are left out, since there it makes up
// values half a cell wide.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gdal_alg.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::Outcome;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

constexpr double kInterval = 20;
constexpr double kBase = 0.5;  // no sample of whole metres is at a level

struct Raster {
  explicit Raster(const std::string& path) : dataset(GDALDataset::Open(path.c_str())) {
    dataset->GetGeoTransform(g.data());
    width = dataset->GetRasterXSize(), height = dataset->GetRasterYSize();
    GDALRasterBand* band = dataset->GetRasterBand(1);
    int has_nodata = 0;
    const double nodata = band->GetNoDataValue(&has_nodata);
    std::vector<double> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    EXPECT_EQ(band->RasterIO(GF_Read, 0, 0, width, height, values.data(), width, height,
                             GDT_Float64, 0, 0, nullptr),
              CE_None);
    for (const double v : values) valid.push_back(has_nodata == 0 || v != nodata);
  }
  [[nodiscard]] bool is_valid(int column, int row) const {
    return column >= 0 && row >= 0 && column < width && row < height &&
           valid[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(column)];
  }
  [[nodiscard]] bool is_whole(int column, int row) const {
    return is_valid(column, row) && is_valid(column + 1, row) && is_valid(column, row + 1) &&
           is_valid(column + 1, row + 1);
  }
  GDALDatasetUniquePtr dataset;
  std::array<double, 6> g{};
  int width = 0, height = 0;
  std::vector<bool> valid;
};

/// A side of a cell: level, column, row, and whether it runs along the row.
using Side = std::tuple<double, int, int, bool>;

/// Where lines cut the sides of cells: the place along the side, 0 to 1.
struct Cuts {
  std::map<Side, double> on_sides;
  std::size_t inside = 0;  ///< Points in no side.
};

void add_point(const Raster& raster, double level, double x, double y, Cuts& cuts) {
  constexpr double kNear = 1e-6;
  const double column = (x - raster.g[0]) / raster.g[1] - 0.5;
  const double row = (y - raster.g[3]) / raster.g[5] - 0.5;
  const bool on_column = std::abs(column - std::round(column)) < kNear;
  const bool on_row = std::abs(row - std::round(row)) < kNear;
  if (!on_column && !on_row) {
    ++cuts.inside;
    return;
  }
  const int c = static_cast<int>(on_column ? std::round(column) : std::floor(column));
  const int r = static_cast<int>(on_row ? std::round(row) : std::floor(row));
  const bool beside_whole_cells = on_row ? raster.is_whole(c, r - 1) && raster.is_whole(c, r)
                                         : raster.is_whole(c - 1, r) && raster.is_whole(c, r);
  if (beside_whole_cells) {
    cuts.on_sides[{level, c, r, on_row}] = on_row ? column - c : row - r;
  }
}

Cuts cuts_of(OGRLayer& layer, const Raster& raster) {
  Cuts cuts;
  for (const auto& feature : layer) {
    const double level = feature->GetFieldAsDouble("elev");
    const OGRLineString* line = feature->GetGeometryRef()->toLineString();
    for (int i = 0; i < line->getNumPoints(); ++i) {
      add_point(raster, level, line->getX(i), line->getY(i), cuts);
    }
  }
  return cuts;
}

Cuts cuts_of_gdal(const Raster& raster, double interval) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("Memory");
  const GDALDatasetUniquePtr memory(driver->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = memory->CreateLayer("contour", nullptr, wkbLineString, nullptr);
  OGRFieldDefn id("ID", OFTInteger);
  OGRFieldDefn elev("elev", OFTReal);
  EXPECT_EQ(layer->CreateField(&id), OGRERR_NONE);
  EXPECT_EQ(layer->CreateField(&elev), OGRERR_NONE);
  GDALRasterBand* band = raster.dataset->GetRasterBand(1);
  EXPECT_EQ(GDALContourGenerate(band, interval, kBase, 0, nullptr, band->GetNoDataValue() != -1e10,
                                band->GetNoDataValue(), layer, 0, 1, nullptr, nullptr),
            CE_None);
  return cuts_of(*layer, raster);
}

void compare(const std::string& path, double interval = kInterval) {
  const TestFolder folder;
  GDALAllRegister();
  ASSERT_EQ(run_ptin({"build", path, "-o", folder.file("t.ptin"), "-q"}).status, 0);
  const Outcome outcome =
      run_ptin({"isoline", folder.file("t.ptin"), "--interval", std::to_string(interval), "--base",
                std::to_string(kBase), "-o", folder.file("c.fgb"), "-q"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Raster raster(path);
  const GDALDatasetUniquePtr written(
      GDALDataset::Open(folder.file("c.fgb").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  ASSERT_NE(written, nullptr);
  const Cuts ours = cuts_of(*written->GetLayer(0), raster);
  const Cuts theirs = cuts_of_gdal(raster, interval);
  EXPECT_GT(ours.on_sides.size(), 1000U);
  EXPECT_GT(ours.inside, ours.on_sides.size() / 4) << "the cuts on diagonals";
  std::size_t missing = 0;
  double farthest = 0;
  for (const auto& [side, place] : theirs.on_sides) {
    const auto found = ours.on_sides.find(side);
    missing += found == ours.on_sides.end() ? 1 : 0;
    if (found != ours.on_sides.end()) {
      farthest = std::max(farthest, std::abs(found->second - place));
    }
  }
  EXPECT_EQ(missing, 0U) << path << ": sides that gdal_contour alone cuts";
  EXPECT_EQ(ours.on_sides.size(), theirs.on_sides.size()) << path;
  EXPECT_LT(farthest, 1e-5) << path << ": of a side";
}

TEST(IsolineBesideGdal, CutsTheSidesOfCellsInTheSamePlaces) {
  compare(test_data("mountains_257.tif"));
  compare(test_data("coast_257.tif"));
}

TEST(IsolineBesideGdal, CutsTheSidesOfALargerMountainInTheSamePlaces) {
  const std::string path = std::string(PTIN_SHARED_DATA) + "/srtm1_bigtujunga_utm_1197x643.tif";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "needs " << path;
  }
  compare(path, kInterval * test::share_of_cases(3));
}

}  // namespace
}  // namespace ptin::tools
