// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters for `verify --against`.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include <gdal_priv.h>

#include "engine/construct/raster/vrt_background.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "tools/facts/human.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

namespace {

/// One file, and where its pixels are on the grid: x = first_x + x_step * column, y = first_y +
/// y_step * row.
struct SampledRaster {
  std::string path;
  std::unique_ptr<GDALDataset> data;
  std::int64_t first_x = 0;
  std::int64_t first_y = 0;
  int x_step = 1;  ///< 1 or -1.
  int y_step = -1;
  int columns = 0;
  int rows = 0;
  GDALRasterBand* heights = nullptr;  ///< A band of `data`, as the next one.
  GDALRasterBand* alpha = nullptr;    ///< Null where there is none.
  /// A VRT once more, NaN where no source covers it.
  GDALDatasetUniquePtr backed{};
  std::optional<double> nodata;  ///< The value that the file declares.
  int bits_of_float = 32;        ///< Bits of a value of Float32.
  double scale = 1.0;
  double offset = 0.0;

  [[nodiscard]] std::int64_t low_x() const { return x_step < 0 ? first_x - columns + 1 : first_x; }
  [[nodiscard]] std::int64_t high_x() const { return low_x() + columns - 1; }
  [[nodiscard]] std::int64_t low_y() const { return y_step < 0 ? first_y - rows + 1 : first_y; }
  [[nodiscard]] std::int64_t high_y() const { return low_y() + rows - 1; }
};

class RasterSamples final : public SourceSamples {
 public:
  RasterSamples(std::vector<SampledRaster> files, const StoreFile& store)
      : files_(std::move(files)), choices_(choices_of(store)) {
    SourceExtent extent;
    std::vector<std::string> paths;
    for (SampledRaster& file : files_) {
      place(file, store.facts());
      extent.add(static_cast<double>(file.low_x()), static_cast<double>(file.low_y()));
      extent.add(static_cast<double>(file.high_x()), static_cast<double>(file.high_y()));
      paths.push_back(file.path);
    }
    check_extent(extent, paths, store.facts(), choices_);
  }

  [[nodiscard]] SampleWindow read(const GridBox& box) override;
  [[nodiscard]] std::uint64_t count(const GridBox& box) override {
    return static_cast<std::uint64_t>(std::int64_t{box.max_x} - box.min_x + 1) *
           static_cast<std::uint64_t>(std::int64_t{box.max_y} - box.min_y + 1);
  }

 private:
  static void place(SampledRaster& file, const StoreFacts& facts);
  void read_file(SampledRaster& file, SampleWindow& window) const;

  std::vector<SampledRaster> files_;
  SampleChoices choices_;
};

double last_place(double v) { return std::nextafter(std::abs(v), HUGE_VAL) - std::abs(v); }

/// Finds where the pixels of a file stand on the grid, and refuses a file where they do not stand
/// on it.
void RasterSamples::place(SampledRaster& file, const StoreFacts& facts) {
  std::array<double, 6> t{0, 1, 0, 0, 0, -1};
  // A geotransform that says nothing counts as none; it is what GDAL gives for none, but for a VRT, in
  // which one is written or none.
  const bool is_vrt = EQUAL(file.data->GetDriverName(), "VRT");
  if (file.data->GetGeoTransform(t.data()) != CE_None ||
      (t == std::array<double, 6>{0, 1, 0, 0, 0, 1} && !is_vrt))
    t = {-0.5, 1, 0, file.rows - 0.5, 0, -1};
  file.x_step = t[1] < 0 ? -1 : 1;
  file.y_step = t[5] < 0 ? -1 : 1;
  const auto grid = [&](int column, int row) {
    return facts.map.to_grid({t[0] + (column + 0.5) * t[1] + (row + 0.5) * t[2],
                              t[3] + (column + 0.5) * t[4] + (row + 0.5) * t[5]});
  };
  const MapPoint first = grid(0, 0);
  const MapPoint last = grid(file.columns - 1, file.rows - 1);
  file.first_x = std::llround(first.x);
  file.first_y = std::llround(first.y);
  const auto expected_x =
      static_cast<double>(file.first_x + std::int64_t{file.x_step} * (file.columns - 1));
  const auto expected_y =
      static_cast<double>(file.first_y + std::int64_t{file.y_step} * (file.rows - 1));
  // A skew moves the other two corners away.
  const MapPoint across = grid(file.columns - 1, 0);
  const MapPoint along = grid(0, file.rows - 1);
  const double skew = std::max({std::abs(across.y - first.y), std::abs(across.x - last.x),
                                std::abs(along.x - first.x), std::abs(along.y - last.y)});
  const double off = std::max({skew, std::abs(first.x - static_cast<double>(file.first_x)),
                               std::abs(first.y - static_cast<double>(file.first_y)),
                               std::abs(last.x - expected_x), std::abs(last.y - expected_y)});
  constexpr double kPlaces = 4;  // Last places that rounding may cost.
  const double coarse =
      std::max(last_place(t[0]) / std::abs(t[1]), last_place(t[3]) / std::abs(t[5]));
  if (off > 0.02 + kPlaces * coarse) {
    refuse("not the source of this file: its samples stand on another grid, up to " +
               short_number(off) + " grid units beside the terrain's",
           file.path);
  }
}

/// True for signed bytes. They come from GDAL before 3.7 as 0 to 255.
bool is_signed_byte(GDALRasterBand& band) {
  const char* type = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return type != nullptr && EQUAL(type, "SIGNEDBYTE");
}

struct PixelWindow {
  int column, row, width, height;
};

/// Reads numbers of floats as their type has them, and others as doubles.
CPLErr read_numbers(GDALRasterBand& band, const PixelWindow& w, std::vector<double>& values) {
  const bool is_float = band.GetRasterDataType() == GDT_Float32;
  std::vector<float> floats(is_float ? values.size() : 0);
  void* const to = is_float ? static_cast<void*>(floats.data()) : values.data();
  const CPLErr status =
      band.RasterIO(GF_Read, w.column, w.row, w.width, w.height, to, w.width, w.height,
                    is_float ? GDT_Float32 : GDT_Float64, 0, 0, nullptr);
  if (is_float) std::copy(floats.begin(), floats.end(), values.begin());
  return status;
}

/// Numbers as the type of their band has them. GDAL works those of a VRT out in the type that is asked
/// for, and neither rounds nor clamps them to the band's own.
/// @param has_gaps  NaN stays: no source is there.
void take_type(GDALDataType type, bool has_gaps, std::vector<double>& values) {
  const int size = GDALGetDataTypeSizeBytes(type);
  for (double& value : values) {
    if (has_gaps && std::isnan(value)) continue;
    double stored = 0.0;  // of any type
    GDALCopyWords(&value, GDT_Float64, 0, &stored, type, size, 1);
    GDALCopyWords(&stored, type, size, &value, GDT_Float64, 0, 1);
  }
}

/// True where a stored value is the nodata value, as the file's type may have rounded that. Floats of
/// fewer bits than Float32 are looked at by their own last place.
bool is_nodata(double stored, double nodata, GDALDataType type, int bits_of_float) {
  if (stored == nodata) return true;
  if (type != GDT_Float32 && type != GDT_Float64) return false;
  if (type == GDT_Float64 && std::isinf(nodata)) return false;
  constexpr double kHasFewDigits = 1e30;  // from here on a nodata value has but three sure digits
  if (std::abs(nodata) >= kHasFewDigits) {
    const bool overflows = type == GDT_Float32 && std::abs(nodata) >= 3.41e38;
    const double most = std::numeric_limits<float>::max();
    return overflows ? stored * std::copysign(1.0, nodata) >= most
                     : std::abs(stored - nodata) <= 1e-3 * std::abs(nodata);
  }
  if (type == GDT_Float32 && bits_of_float == 16 && std::abs(nodata) > 65504)
    return stored * std::copysign(1.0, nodata) >= 65504;
  if (type == GDT_Float32 && bits_of_float < 32) {
    const int kept = bits_of_float == 16 ? 10 : 16;
    return std::abs(stored - nodata) < std::ldexp(1.0, std::ilogb(nodata) - kept);
  }
  const double single = static_cast<float>(nodata);
  return type == GDT_Float32
             ? stored == single
             : std::min(single, nodata) <= stored && stored <= std::max(single, nodata);
}

SampleWindow RasterSamples::read(const GridBox& box) {
  SampleWindow window;
  window.box = box;
  window.is_grid = true;
  for (std::int32_t y = box.min_y; y <= box.max_y; ++y) {
    for (std::int32_t x = box.min_x; x <= box.max_x; ++x)
      window.samples.push_back({x, y, 0.0, true});
  }
  for (SampledRaster& file : files_) read_file(file, window);
  return window;
}

void RasterSamples::read_file(SampledRaster& file, SampleWindow& window) const {
  const GridBox& box = window.box;
  const std::int64_t low_x = std::max<std::int64_t>(box.min_x, file.low_x());
  const std::int64_t high_x = std::min<std::int64_t>(box.max_x, file.high_x());
  const std::int64_t low_y = std::max<std::int64_t>(box.min_y, file.low_y());
  const std::int64_t high_y = std::min<std::int64_t>(box.max_y, file.high_y());
  if (low_x > high_x || low_y > high_y) return;
  const int width = static_cast<int>(high_x - low_x + 1);
  const int height = static_cast<int>(high_y - low_y + 1);
  const int column =
      static_cast<int>(file.x_step < 0 ? file.first_x - high_x : low_x - file.first_x);
  const int row = static_cast<int>(file.y_step < 0 ? file.first_y - high_y : low_y - file.first_y);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<double> values(count);
  std::vector<std::uint8_t> mask(count, 255);
  GDALRasterBand& band = *file.heights;
  GDALRasterBand& read_from = file.backed ? *file.backed->GetRasterBand(band.GetBand()) : band;
  CPLErr status = read_numbers(read_from, {column, row, width, height}, values);
  if (EQUAL(file.data->GetDriverName(), "VRT"))
    take_type(band.GetRasterDataType(), file.backed != nullptr, values);
  // A nodata value given at the build takes the place of the file's own; other masks stay. A mask
  // that stands for the band's nodata value alone is left to is_nodata(), one of alpha to its band.
  const int flags = band.GetMaskFlags();
  const bool is_own =
      (flags & GMF_NODATA) != 0 && (choices_.nodata.has_value() || (flags & GMF_PER_DATASET) == 0);
  if (status == CE_None && !is_own && (flags & GMF_ALPHA) == 0) {
    status = band.GetMaskBand()->RasterIO(GF_Read, column, row, width, height, mask.data(), width,
                                          height, GDT_Byte, 0, 0, nullptr);
  }
  std::vector<double> alpha(count, 1.0);
  if (status == CE_None && file.alpha != nullptr) {
    status = file.alpha->RasterIO(GF_Read, column, row, width, height, alpha.data(), width, height,
                                  GDT_Float64, 0, 0, nullptr);
  }
  if (status != CE_None)
    throw Error(ErrorCode::io_error, "GDAL cannot read its samples", file.path);
  if (is_signed_byte(band)) {
    for (double& value : values) value -= value > 127 ? 256 : 0;
  }
  const std::optional<double> nodata = choices_.nodata ? choices_.nodata : file.nodata;
  const std::size_t stride = static_cast<std::size_t>(box.max_x - box.min_x) + 1;
  for (int j = 0; j < height; ++j) {
    const std::int64_t y = file.y_step < 0 ? high_y - j : low_y + j;
    for (int i = 0; i < width; ++i) {
      const std::int64_t x = file.x_step < 0 ? high_x - i : low_x + i;
      const std::size_t from = static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(i);
      const double value = values[from];
      const bool is_void =
          mask[from] == 0 || !(alpha[from] > 0) || std::isnan(value) ||
          (nodata && is_nodata(value, *nodata, band.GetRasterDataType(), file.bits_of_float));
      if (is_void) continue;
      SourceSample& sample = window.samples[static_cast<std::size_t>(y - box.min_y) * stride +
                                            static_cast<std::size_t>(x - box.min_x)];
      sample.height = file.offset + file.scale * value;
      sample.is_void = false;
    }
  }
}

/// One of two bands may be alpha.
void choose_bands(SampledRaster& file) {
  file.heights = file.data->GetRasterBand(1);
  if (file.data->GetRasterCount() == 2) {
    GDALRasterBand* second = file.data->GetRasterBand(2);
    if (second->GetColorInterpretation() == GCI_AlphaBand) file.alpha = second;
    if (file.alpha == nullptr && file.heights->GetColorInterpretation() == GCI_AlphaBand) {
      file.alpha = file.heights;
      file.heights = second;
    }
  }
  int has = 0;
  const GDALDataType type = file.heights->GetRasterDataType();
  const double nodata =
      type == GDT_Int64    ? static_cast<double>(file.heights->GetNoDataValueAsInt64(&has))
      : type == GDT_UInt64 ? static_cast<double>(file.heights->GetNoDataValueAsUInt64(&has))
                           : file.heights->GetNoDataValue(&has);
  if (has != 0) file.nodata = nodata;
  const char* bits = file.heights->GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
  if (bits != nullptr) file.bits_of_float = std::atoi(bits);
}

}  // namespace

std::unique_ptr<SourceSamples> open_raster_samples(const std::vector<std::string>& paths,
                                                   const StoreFile& store) {
  std::vector<SampledRaster> files;
  for (const std::string& path : paths) {
    SampledRaster file;
    file.path = path;
    file.data.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr,
                                      nullptr, nullptr));
    if (!file.data) require_readable(path);
    if (!file.data || file.data->GetRasterCount() < 1) {
      refuse(
          "neither a raster that GDAL reads nor points, a TIN or a layer; name the inputs of the "
          "build behind --against",
          path);
    }
    choose_bands(file);
    file.backed = open_with_background(*file.data, "nan");
    if (file.backed && file.backed->GetRasterCount() > file.data->GetRasterCount())
      file.alpha = file.backed->GetRasterBand(file.backed->GetRasterCount());
    GDALRasterBand& band = *file.heights;
    file.columns = band.GetXSize();
    file.rows = band.GetYSize();
    file.scale = band.GetScale(nullptr);
    file.offset = band.GetOffset(nullptr);
    files.push_back(std::move(file));
  }
  return std::make_unique<RasterSamples>(std::move(files), store);
}

}  // namespace ptin::tools
