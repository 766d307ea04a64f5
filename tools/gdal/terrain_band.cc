// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/terrain_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stop_token>

#include "engine/crs/ground.h"
#include "tools/gdal/guard.h"
#include "tools/gdal/terrain_dataset.h"

namespace ptin::tools {

namespace {

constexpr int kBlockSide = 256;

int halved(int side, int times) { return ((side - 1) >> times) + 1; }

/// Whether the window that GDAL was given lies between pixels. rasterio and VRT
/// give each as real numbers, whole ones too, which may have been computed.
bool has_fractions(const GDALRasterIOExtraArg* extra, const std::array<int, 4>& whole) {
  if (extra == nullptr || extra->bFloatingPointWindowValidity == FALSE) return false;
  constexpr double kRounding = 1e-8;
  const std::array real = {extra->dfXOff, extra->dfYOff, extra->dfXSize, extra->dfYSize};
  return !std::equal(real.begin(), real.end(), whole.begin(),
                     [](double a, int b) { return std::abs(a - b) <= kRounding; });
}

/// How far heights at most lie from those of the TIN when they are pixels of a type.
double rounding_of(GDALDataType type, const StoreFacts& facts) {
  if (type != GDT_Float32) return 0.0;
  const auto largest =
      static_cast<float>(std::max(std::abs(facts.min_height), std::abs(facts.max_height)));
  return (std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest) / 2;
}

}  // namespace

TerrainBand::TerrainBand(TerrainDataset& dataset) : TerrainBand(dataset, 0) {
  poDS = &dataset;
  nBand = 1;
  for (int i = 1; std::max(nRasterXSize, nRasterYSize) >> (i - 1) > kBlockSide; ++i) {
    overviews_.emplace_back(new TerrainBand(dataset, i));
  }
}

TerrainBand::TerrainBand(TerrainDataset& dataset, int shift)
    : dataset_(dataset),
      nodata_(default_nodata(dataset.facts(), dataset.options().content.value)),
      unit_(unit_of_pixels(dataset.options().content, dataset.crs())),
      per_map_unit_(ground_of(dataset.crs()).per_map_unit) {
  eDataType = type_of_pixels(dataset.facts(), dataset.options().content.value);
  eAccess = GA_ReadOnly;
  nBlockXSize = nBlockYSize = kBlockSide;
  nRasterXSize = halved(dataset.GetRasterXSize(), shift);
  nRasterYSize = halved(dataset.GetRasterYSize(), shift);
  if (dataset.options().content.value == PixelValue::kHeight) tell_certified();
}

/// What is certified of heights, that of pixels of this size. Sampled heights that the TIN meets are
/// those of a vertex or of a plane, which the type holds.
void TerrainBand::tell_certified() {
  const Part whole{0, 0, 1.0 * nRasterXSize, 1.0 * nRasterYSize};
  const DetailRequest detail = request_for(whole, nRasterXSize, nRasterYSize).detail;
  Certificate certificate = dataset_.certificate_of(detail);
  const double rounding = rounding_of(eDataType, dataset_.facts());
  if (certificate.error > 0) certificate.error += rounding;
  certificate.deviation += rounding;
  tell_certificate(certificate, *this);
}

GDALRasterBand* TerrainBand::GetOverview(int i) {
  if (i < 0 || i >= GetOverviewCount()) return nullptr;
  return overviews_[static_cast<std::size_t>(i)].get();
}

double TerrainBand::GetNoDataValue(int* is_there) {
  if (is_there != nullptr) *is_there = TRUE;
  return nodata_;
}

bool TerrainBand::has_range() const noexcept {
  return dataset_.options().content.value == PixelValue::kHeight &&
         dataset_.facts().min_height <= dataset_.facts().max_height;
}

double TerrainBand::GetMinimum(int* is_there) {
  if (!has_range()) return GDALRasterBand::GetMinimum(is_there);
  if (is_there != nullptr) *is_there = TRUE;
  return dataset_.facts().min_height;
}

double TerrainBand::GetMaximum(int* is_there) {
  if (!has_range()) return GDALRasterBand::GetMaximum(is_there);
  if (is_there != nullptr) *is_there = TRUE;
  return dataset_.facts().max_height;
}

CPLErr TerrainBand::ComputeRasterMinMax(int is_approximate, double* min_max) {
  if (!has_range()) return GDALRasterBand::ComputeRasterMinMax(is_approximate, min_max);
  min_max[0] = dataset_.facts().min_height;
  min_max[1] = dataset_.facts().max_height;
  return CE_None;
}

// NOLINTNEXTLINE(readability-function-size): GDAL's parameters
CPLErr TerrainBand::ComputeStatistics(int is_approximate, double* min, double* max, double* mean,
                                      double* deviation, GDALProgressFunc progress, void* data) {
  double low = 0.0, high = 0.0, middle = 0.0, spread = 0.0;
  const CPLErr result = GDALRasterBand::ComputeStatistics(is_approximate, &low, &high, &middle,
                                                          &spread, progress, data);
  if (result != CE_None) return result;
  if (has_range()) {
    low = dataset_.facts().min_height;
    high = dataset_.facts().max_height;
  }
  const auto give = [](double* to, double value) {
    if (to != nullptr) *to = value;
  };
  give(min, low), give(max, high), give(mean, middle), give(deviation, spread);
  return SetStatistics(low, high, middle, spread);
}

CPLErr TerrainBand::IReadBlock(int column, int row, void* data) {
  const int first_column = column * nBlockXSize;
  const int first_row = row * nBlockYSize;
  const int width = std::min(nBlockXSize, nRasterXSize - first_column);
  const int height = std::min(nBlockYSize, nRasterYSize - first_row);
  const GSpacing space = GDALGetDataTypeSizeBytes(eDataType);
  const Target target{data, width, height, eDataType, space, space * nBlockXSize};
  const Part part{1.0 * first_column, 1.0 * first_row, 1.0 * width, 1.0 * height};
  return guarded([&] { sample(part, target, nullptr); }) ? CE_None : CE_Failure;
}

// NOLINTNEXTLINE(readability-function-size): GDAL's parameters
CPLErr TerrainBand::IRasterIO(GDALRWFlag mode, int column, int row, int width, int height,
                              void* data, int columns, int rows, GDALDataType type,
                              GSpacing pixel_space, GSpacing line_space,
                              GDALRasterIOExtraArg* extra) {
  // GDAL's statistics and histograms say 0 where pixels follow one another.
  if (pixel_space == 0) pixel_space = GDALGetDataTypeSizeBytes(type);
  if (line_space == 0) line_space = pixel_space * columns;
  Part part{1.0 * column, 1.0 * row, 1.0 * width, 1.0 * height};
  const bool is_between = has_fractions(extra, {column, row, width, height});
  if (is_between) part = {extra->dfXOff, extra->dfYOff, extra->dfXSize, extra->dfYSize};
  // Programs that go line by line or by other small windows get GDAL's cache of blocks, so that no
  // page is read for each line.
  const bool is_small = width < nBlockXSize || height < nBlockYSize;
  if (mode != GF_Read || (width == columns && height == rows && !is_between && is_small)) {
    return GDALRasterBand::IRasterIO(mode, column, row, width, height, data, columns, rows, type,
                                     pixel_space, line_space, extra);
  }
  const Target target{data, columns, rows, type, pixel_space, line_space};
  return guarded([&] { sample(part, target, extra); }) ? CE_None : CE_Failure;
}

RasterRequest TerrainBand::request_for(const Part& part, int columns, int rows) const {
  // An overview covers the same ground as the full raster, so its pixels are not quite 2^n as large.
  const double own_width = 1.0 * dataset_.GetRasterXSize() / nRasterXSize;
  const double own_height = 1.0 * dataset_.GetRasterYSize() / nRasterYSize;
  const double times_wide = own_width * part.width / columns;
  const double times_high = own_height * part.height / rows;
  RasterRequest request = dataset_.pixels();
  PixelLattice& lattice = request.lattice;
  const MapPoint first = lattice.centre(request.pixels.column, request.pixels.row);
  lattice.origin = {first.x + lattice.step_x * (part.column * own_width + (times_wide - 1) / 2),
                    first.y + lattice.step_y * (part.row * own_height + (times_high - 1) / 2)};
  lattice.step_x *= times_wide;
  lattice.step_y *= times_high;
  request.pixels = {0, 0, columns, rows};
  request.detail = dataset_.detail_for_pixels(std::abs(lattice.step_x), std::abs(lattice.step_y));
  request.heights = dataset_.options().content.value == PixelValue::kHeight;
  request.normals = !request.heights;
  return request;
}

void TerrainBand::sample(const Part& part, const Target& target,
                         const GDALRasterIOExtraArg* extra) const {
  RasterRequest request = request_for(part, target.columns, target.rows);
  std::stop_source stop;
  request.limits.stop = stop.get_token();
  if (extra != nullptr && extra->pfnProgress != nullptr) {
    request.progress = [&](double done) {
      if (extra->pfnProgress(done, "", extra->pProgressData) == FALSE) stop.request_stop();
    };
  }
  dataset_.terrain().raster(request,
                            [&](const RasterBlock& block) { store(block, request, target); });
}

/// Writes a block of what was asked for where GDAL wants it, with GDAL's rounding for its type: of the
/// band's type first, as what comes by GDAL's blocks is.
void TerrainBand::store(const RasterBlock& block, const RasterRequest& request,
                        const Target& target) const {
  const auto width = static_cast<std::size_t>(block.pixels.width);
  const int own_size = GDALGetDataTypeSizeBytes(eDataType);
  std::vector<double> values(width);
  std::vector<GByte> rounded(width * static_cast<std::size_t>(own_size));
  for (std::int64_t y = 0; y < block.pixels.height; ++y) {
    const std::size_t first = static_cast<std::size_t>(y) * block.stride;
    for (std::size_t x = 0; x < width; ++x) {
      if (block.heights != nullptr) {
        const double height = block.heights[first + x];
        values[x] = std::isnan(height) ? nodata_ : height;
        continue;
      }
      const MapPoint centre = request.lattice.centre(
          block.pixels.column + static_cast<std::int64_t>(x), block.pixels.row + y);
      values[x] = value_at(block.normals[first + x], dataset_.options().content, dataset_.facts(),
                           per_map_unit_(centre))
                      .value_or(nodata_);
    }
    auto* const to = static_cast<GByte*>(target.data) + (block.pixels.row + y) * target.line_space +
                     block.pixels.column * target.pixel_space;
    GDALCopyWords64(values.data(), GDT_Float64, sizeof(double), rounded.data(), eDataType, own_size,
                    block.pixels.width);
    GDALCopyWords64(rounded.data(), eDataType, own_size, to, target.type,
                    static_cast<int>(target.pixel_space), block.pixels.width);
  }
}

}  // namespace ptin::tools
