// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_part.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/error.h"
#include "engine/geometry/point.h"
#include "storage/file/file_questions.h"

namespace ptin {
namespace {

GDALDatasetUniquePtr open_dataset(const std::string& path) {
  const GdalSession session;
  static constexpr unsigned kFlags = GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR;
  GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), kFlags));
  if (data != nullptr) {
    return data;
  }
  VSIStatBufL status;
  if (VSIStatL(path.c_str(), &status) != 0) {
    throw Error(ErrorCode::not_found, session.explain("there is no such raster"), path);
  }
  require_readable(path);
  refuse(session.explain("this is neither a raster nor a layer that GDAL reads; LAS, text and "
                         "TINs are known by their names: .las, .csv, .xyz, .txt, .ply, .obj, .2dm, "
                         ".xml"),
         path);
}

/// The band with the heights: the only one, or the one beside an alpha band.
GDALRasterBand* height_band(GDALDataset& data, const std::string& path) {
  const int bands = data.GetRasterCount();
  if (bands == 0) {
    const char* subset = data.GetMetadataItem("SUBDATASET_1_NAME", "SUBDATASETS");
    refuse(subset == nullptr
               ? std::string("this raster has no band")
               : "this file holds several rasters; name one, such as " + std::string(subset),
           path);
  }
  const bool with_alpha =
      bands == 2 && data.GetRasterBand(2)->GetColorInterpretation() == GCI_AlphaBand;
  if (bands > 1 && !with_alpha) {
    refuse("this raster has " + std::to_string(bands) +
               " bands where one of heights is expected; take it out with "
               "'gdal_translate -b NUMBER'",
           path);
  }
  return data.GetRasterBand(1);
}

/// The band that says where samples are masked out; null where all are valid, and where the nodata
/// value of the band alone decides, which find_valid() compares. A nodata value of the whole
/// dataset (NODATA_VALUES) is known to the mask only, so the mask is needed there.
/// @param is_overridden  The caller's nodata value replaces any declared one.
GDALRasterBand* mask_band(GDALRasterBand& band, bool is_overridden) {
  const int flags = band.GetMaskFlags();
  const bool by_value =
      (flags & GMF_NODATA) != 0 && (is_overridden || (flags & GMF_PER_DATASET) == 0);
  return by_value || (flags & GMF_ALL_VALID) != 0 ? nullptr : band.GetMaskBand();
}

std::optional<double> declared_nodata(GDALRasterBand& band) {
  int has = 0;
  double value = 0.0;
  switch (band.GetRasterDataType()) {
    case GDT_Int64:
      value = static_cast<double>(band.GetNoDataValueAsInt64(&has));
      break;
    case GDT_UInt64:
      value = static_cast<double>(band.GetNoDataValueAsUInt64(&has));
      break;
    default:
      value = band.GetNoDataValue(&has);
  }
  return has != 0 ? std::optional<double>(value) : std::nullopt;
}

/// Before GDAL 3.7 there is no type for signed bytes: they are handed out as 0 to 255.
bool holds_signed_bytes(GDALRasterBand& band) {
  const char* pixel_type = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return band.GetRasterDataType() == GDT_Byte && pixel_type != nullptr &&
         EQUAL(pixel_type, "SIGNEDBYTE");
}

void describe_values(GDALRasterBand& band, const std::string& path, RasterShape& shape) {
  const GDALDataType type = band.GetRasterDataType();
  shape.type_name = GDALGetDataTypeName(type);
  if (GDALDataTypeIsComplex(type)) {
    refuse("this raster holds complex numbers (" + shape.type_name + "), not heights", path);
  }
  shape.signed_bytes = holds_signed_bytes(band);
  shape.scale = band.GetScale();
  shape.offset = band.GetOffset();
  if (!std::isfinite(shape.scale) || !std::isfinite(shape.offset) || shape.scale == 0.0) {
    refuse("the raster's scale must be finite and not 0, and its offset finite", path);
  }
  const bool scaled = shape.scale != 1.0 || shape.offset != 0.0;
  const bool fits_int32 =
      type == GDT_Byte || type == GDT_UInt16 || type == GDT_Int16 || type == GDT_Int32;
  if (fits_int32 && shape.scale > 0.0) {
    shape.raw = RawType::kInt32;
  } else if (type == GDT_Float32 && !scaled) {
    shape.raw = RawType::kFloat32;
  } else {
    shape.raw = RawType::kFloat64;
  }
  // The range of integers is checked here, once for all; floats are checked one by one
  // (check_heights).
  const double largest = std::ldexp(1.0, type == GDT_Byte ? 8 : type == GDT_Int32 ? 31 : 16);
  if (shape.raw == RawType::kInt32 &&
      std::abs(shape.scale) * largest + std::abs(shape.offset) > FLT_MAX) {
    refuse("the raster's scale or offset is so large that heights may be beyond 3.4e38", path);
  }
  shape.unit = band.GetUnitType();
  band.GetBlockSize(&shape.block[0], &shape.block[1]);
}

/// The affine map of the file, turned so that both axes grow and samples stand at pixel centres.
/// GDAL's geotransform speaks of pixel corners whether the file calls its pixels areas or points.
void describe_place(GDALDataset& data, const std::string& path, RasterShape& shape) {
  shape.width = data.GetRasterXSize();
  shape.height = data.GetRasterYSize();
  if (shape.width - 1 > kGridMax || shape.height - 1 > kGridMax) {
    refuse("this raster has more than 2^30 columns or rows, which is the limit of the grid", path);
  }
  double t[6];
  const bool plain = data.GetGeoTransform(t) != CE_None ||
                     std::equal(t, t + 6, std::array<double, 6>{0, 1, 0, 0, 0, 1}.begin());
  if (plain) {
    if (data.GetGCPCount() > 0) {
      refuse(
          "this raster is placed by ground control points alone; warp it with 'gdalwarp' "
          "first",
          path);
    }
    return;  // the identity, in pixels
  }
  shape.georeferenced = true;
  if (!std::all_of(t, t + 6, [](double v) { return std::isfinite(v); }) || t[1] == 0 || t[5] == 0) {
    refuse("this raster has an impossible geotransform", path);
  }
  const double skew = std::max(std::abs(t[2] / t[1]) * static_cast<double>(shape.height),
                               std::abs(t[4] / t[5]) * static_cast<double>(shape.width));
  if (skew > 1e-3) {
    refuse("this raster is rotated or sheared; make it north-up with 'gdalwarp' first", path);
  }
  shape.columns_from_east = t[1] < 0;
  shape.rows_from_south = t[5] > 0;
  const double west = shape.columns_from_east ? static_cast<double>(shape.width) - 0.5 : 0.5;
  const double south = shape.rows_from_south ? 0.5 : static_cast<double>(shape.height) - 0.5;
  shape.map = {t[0] + t[1] * west, t[3] + t[5] * south, std::abs(t[1]), std::abs(t[5])};
}

std::string declared_crs(GDALDataset& data) {
  const OGRSpatialReference* srs = data.GetSpatialRef();
  if (srs == nullptr || srs->IsEmpty()) {
    return "";
  }
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  srs->exportToWkt(&text, options);
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

/// The range [low, high] of the raw values that count as the nodata value; an empty range when no
/// value does. The nodata value is first converted to the file's type, since it is often written
/// with fewer digits than its float32 has. Of a huge one (-3.4e38) everything within a millionth of
/// it counts.
template <class T>
std::pair<T, T> nodata_range(std::optional<double> nodata) {
  const std::pair<T, T> none{std::numeric_limits<T>::max(), std::numeric_limits<T>::lowest()};
  if (!nodata || std::isnan(*nodata)) {
    return none;
  }
  const double value = *nodata;
  if constexpr (std::is_integral_v<T>) {
    const bool fits = value >= std::numeric_limits<T>::lowest() &&
                      value <= std::numeric_limits<T>::max() && value == std::trunc(value);
    return fits ? std::pair<T, T>{static_cast<T>(value), static_cast<T>(value)} : none;
  } else {
    static constexpr double kHuge = 1e30;
    const auto clamped = [](double v) {
      static constexpr double kLargest = static_cast<double>(std::numeric_limits<T>::max());
      return static_cast<T>(std::clamp(v, -kLargest, kLargest));
    };
    if (std::isinf(value)) {
      return {static_cast<T>(value), static_cast<T>(value)};
    }
    if (std::abs(value) < kHuge) {
      return {clamped(value), clamped(value)};
    }
    const T a = clamped(value * (1.0 - 1e-6)), b = clamped(value * (1.0 + 1e-6));
    return {std::min(a, b), std::max(a, b)};
  }
}

/// Sets `valid` from the nodata value, and to 0 for NaN; the mask is not looked at. Returns false
/// when a valid value is no height: it is infinite, or beyond the range of a float32 once scaled.
template <class T>
bool find_valid(std::span<const T> values, std::span<std::uint8_t> valid,
                std::optional<double> nodata, const RasterShape& shape) {
  const auto [low, high] = nodata_range<T>(nodata);
  bool all_heights = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T v = values[i];
    bool is_value = !(low <= v && v <= high);
    if constexpr (!std::is_integral_v<T>) {
      is_value = is_value && !std::isnan(v);
      const double height = shape.offset + shape.scale * static_cast<double>(v);
      all_heights = all_heights && (!is_value || std::abs(height) <= double{FLT_MAX});
    }
    valid[i] = is_value;
  }
  return all_heights;
}

/// Reverses the order of the rows of a row-major array.
template <class T>
void reverse_rows(std::span<T> values, std::int64_t width, std::int64_t height) {
  for (std::int64_t low = 0, high = height - 1; low < high; ++low, --high) {
    std::swap_ranges(values.begin() + low * width, values.begin() + (low + 1) * width,
                     values.begin() + high * width);
  }
}

template <class T>
constexpr GDALDataType kGdalType = std::is_same_v<T, std::int32_t> ? GDT_Int32
                                   : std::is_same_v<T, float>      ? GDT_Float32
                                   : std::is_same_v<T, double>     ? GDT_Float64
                                                                   : GDT_Byte;

/// Reads a window of the grid from a band, and turns it to the grid's orientation.
template <class T>
void read_band(GDALRasterBand& band, const RasterShape& shape, const SampleRange& w,
               std::span<T> values, const std::string& path) {
  const GdalSession session;
  const auto column = shape.columns_from_east ? shape.width - w.x0 - w.width : w.x0;
  const auto row = shape.rows_from_south ? w.y0 : shape.height - w.y0 - w.height;
  const auto status = band.RasterIO(GF_Read, static_cast<int>(column), static_cast<int>(row),
                                    static_cast<int>(w.width), static_cast<int>(w.height),
                                    values.data(), static_cast<int>(w.width),
                                    static_cast<int>(w.height), kGdalType<T>, 0, 0, nullptr);
  if (status != CE_None) {
    throw Error(ErrorCode::io_error,
                session.explain("cannot read the raster near column " + std::to_string(column) +
                                ", row " + std::to_string(row)),
                path);
  }
  if (!shape.rows_from_south) {
    reverse_rows(values, w.width, w.height);
  }
  if (shape.columns_from_east) {
    for (std::int64_t y = 0; y < w.height; ++y) {
      std::reverse(values.begin() + y * w.width, values.begin() + (y + 1) * w.width);
    }
  }
}

template <class T>
bool is_height(T raw, const RasterShape& shape) {
  return std::abs(shape.offset + shape.scale * static_cast<double>(raw)) <= double{FLT_MAX};
}

/// Refuses the first valid value of the window that is no height, if there is one.
template <class T>
void check_heights(const SampleRange& w, std::span<const T> values,
                   std::span<const std::uint8_t> valid, const RasterShape& shape,
                   const std::string& path) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (valid[i] == 0 || is_height(values[i], shape)) {
      continue;
    }
    const std::int64_t x = w.x0 + static_cast<std::int64_t>(i) % w.width;
    const std::int64_t y = w.y0 + static_cast<std::int64_t>(i) / w.width;
    const std::int64_t column = shape.columns_from_east ? shape.width - 1 - x : x;
    const std::int64_t row = shape.rows_from_south ? y : shape.height - 1 - y;
    refuse("the height at column " + std::to_string(column) + ", row " + std::to_string(row) +
               " (counted from 0, as stored) is infinite or beyond 3.4e38; if such values "
               "mean no data, say so with --nodata",
           path);
  }
}

}  // namespace

struct RasterPart::Bands {
  GDALDatasetUniquePtr data;
  GDALRasterBand* height = nullptr;
  GDALRasterBand* mask = nullptr;  ///< Null when the nodata value alone decides.
};

RasterPart::RasterPart(std::string path, std::optional<double> nodata_override)
    : path_(std::move(path)), nodata_override_(nodata_override) {
  open();
  const GdalSession session;
  describe_values(*bands_->height, path_, shape_);
  describe_place(*bands_->data, path_, shape_);
  shape_.crs = declared_crs(*bands_->data);
  nodata_ = nodata_override_ ? nodata_override_ : declared_nodata(*bands_->height);
}

RasterPart::RasterPart(const RasterPart& other)
    : path_(other.path_),
      nodata_override_(other.nodata_override_),
      nodata_(other.nodata_),
      shape_(other.shape_) {}

RasterPart::~RasterPart() { close(); }
RasterPart::RasterPart(RasterPart&&) noexcept = default;
RasterPart& RasterPart::operator=(RasterPart&&) noexcept = default;

void RasterPart::open() {
  auto bands = std::make_unique<Bands>();
  bands->data = open_dataset(path_);
  const GdalSession session;
  bands->height = height_band(*bands->data, path_);
  bands->mask = mask_band(*bands->height, nodata_override_.has_value());
  const bool changed = shape_.width != 0 && (bands->data->GetRasterXSize() != shape_.width ||
                                             bands->data->GetRasterYSize() != shape_.height);
  if (changed) {
    throw Error(ErrorCode::io_error, "the raster changed its size while it was read", path_);
  }
  bands_ = std::move(bands);
}

void RasterPart::close() noexcept {
  if (bands_ != nullptr) {
    const GdalSession session;
    bands_.reset();
  }
}

template <class T>
void RasterPart::read(const SampleRange& window, std::span<T> values,
                      std::span<std::uint8_t> valid) {
  if (!is_open()) {
    open();
  }
  read_band(*bands_->height, shape_, window, values, path_);
  if (shape_.signed_bytes) {
    std::transform(values.begin(), values.end(), values.begin(),
                   [](T v) { return v > T{127} ? v - T{256} : v; });
  }
  const bool all_heights = find_valid<T>(values, valid, nodata_, shape_);
  if (bands_->mask != nullptr) {
    std::vector<std::uint8_t> mask(valid.size());
    read_band<std::uint8_t>(*bands_->mask, shape_, window, mask, path_);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      valid[i] = static_cast<std::uint8_t>(valid[i] & (mask[i] != 0));
    }
  }
  if (!all_heights) {  // the mask may have taken out those that are none
    check_heights<T>(window, values, valid, shape_, path_);
  }
}

template void RasterPart::read(const SampleRange&, std::span<std::int32_t>,
                               std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<float>, std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<double>, std::span<std::uint8_t>);

}  // namespace ptin
