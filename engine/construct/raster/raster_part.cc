// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_part.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <gdal_priv.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/raster/raster_declared.h"
#include "engine/construct/raster/vrt_background.h"
#include "engine/error.h"

namespace ptin {
namespace {

/// The largest floats, in whatever digits: they are what programs write for no height, and no height.
constexpr double kNoHeight = 3.4028e38;

/// The value that stands for no source of a VRT among integers, outside of all types but Int32. Among floats NaN
/// does.
constexpr std::int32_t kBackground = -2'020'304'050;

/// How many numbers of a VRT are compared at once.
constexpr std::int64_t kSamplesAtOnce = std::int64_t{1} << 17;

std::string background_of(RawType raw) {
  return raw == RawType::kInt32 ? std::to_string(kBackground) : "nan";
}

template <class T>
bool is_background(T value) {
  if constexpr (std::is_integral_v<T>) {
    return value == kBackground;
  } else {
    return std::isnan(value);
  }
}

/// False where a stored value is as large as floats get, or infinite, or is so once scaled.
template <class T>
bool is_height(T stored, const RasterShape& shape) {
  const auto value = static_cast<double>(stored);
  return std::abs(value) < kNoHeight && std::abs(shape.offset + shape.scale * value) < kNoHeight;
}

/// Sets `valid` from the nodata values, and to 0 for NaN; masks are not looked at. Returns false when
/// a valid value is no height.
/// @param has_background  Values may be the background of a VRT.
template <class T>
bool find_valid(std::span<const T> values, std::span<std::uint8_t> valid, const NodataRange& nodata,
                const RasterShape& shape, [[maybe_unused]] bool has_background) {
  bool all_heights = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T v = values[i];
    bool is_value = !nodata.holds(static_cast<double>(v));
    if constexpr (!std::is_integral_v<T>) {
      is_value = is_value && !std::isnan(v);
      all_heights = all_heights && (!is_value || is_height(v, shape));
    } else {
      is_value = is_value && !(has_background && is_background(v));
    }
    valid[i] = is_value;
  }
  return all_heights;
}

/// Whether two nodata values are one, NaN too.
bool is_same(std::optional<double> a, std::optional<double> b) {
  return a == b || (a && b && std::isnan(*a) && std::isnan(*b));
}

/// Whether a value is a number as the type of the raster has it, bit for bit.
template <class T>
bool has_bits_of(T value, double number) {
  if constexpr (std::is_integral_v<T>) {
    return static_cast<double>(value) == number;
  } else {
    const T other = static_cast<T>(number);
    return std::memcmp(&value, &other, sizeof value) == 0;
  }
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

/// Turns rows of numbers of a smaller type, which begin where `values` does, into T in place.
template <class T>
void widen(std::span<T> values, std::int64_t width, GDALDataType from) {
  const auto size = static_cast<std::int64_t>(GDALGetDataTypeSizeBytes(from));
  std::vector<T> row(static_cast<std::size_t>(width));
  // From the back on, since no row is longer before than after.
  for (auto at = static_cast<std::int64_t>(values.size()); at > 0;) {
    at -= width;
    GDALCopyWords64(reinterpret_cast<const std::byte*>(values.data()) + at * size, from,
                    static_cast<int>(size), row.data(), kGdalType<T>, sizeof(T), width);
    std::copy(row.begin(), row.end(), values.begin() + at);
  }
}

/// Reads a window of the grid from a band, and turns it to the grid's orientation.
/// @param type  As which GDAL reads it, no larger than T.
template <class T>
void read_band(GDALRasterBand& band, const RasterShape& shape, const SampleRange& w,
               std::span<T> values, const std::string& path, GDALDataType type = kGdalType<T>) {
  const GdalSession session;
  const auto column = shape.columns_from_east ? shape.width - w.x0 - w.width : w.x0;
  const auto row = shape.rows_from_south ? w.y0 : shape.height - w.y0 - w.height;
  const auto status =
      band.RasterIO(GF_Read, static_cast<int>(column), static_cast<int>(row),
                    static_cast<int>(w.width), static_cast<int>(w.height), values.data(),
                    static_cast<int>(w.width), static_cast<int>(w.height), type, 0, 0, nullptr);
  if (status != CE_None) {
    throw Error(ErrorCode::io_error,
                session.explain("cannot read the raster near column " + std::to_string(column) +
                                ", row " + std::to_string(row)),
                path);
  }
  if (type != kGdalType<T>) widen(values, w.width, type);
  if (!shape.rows_from_south) {
    reverse_rows(values, w.width, w.height);
  }
  if (shape.columns_from_east) {
    for (std::int64_t y = 0; y < w.height; ++y) {
      std::reverse(values.begin() + y * w.width, values.begin() + (y + 1) * w.width);
    }
  }
}

/// Rounds and clamps numbers to a type of integers, as GDAL does. The background stays.
template <class T>
void fit_to(GDALDataType type, bool has_background, std::span<T> values) {
  constexpr std::size_t kAtOnce = 1024;
  std::array<double, kAtOnce> fitted;  // of any type
  std::array<T, kAtOnce> back;
  const int size = GDALGetDataTypeSizeBytes(type);
  for (std::size_t from = 0; from < values.size(); from += kAtOnce) {
    const auto part = values.subspan(from, std::min(kAtOnce, values.size() - from));
    const auto count = static_cast<GPtrDiff_t>(part.size());
    GDALCopyWords64(part.data(), kGdalType<T>, sizeof(T), fitted.data(), type, size, count);
    GDALCopyWords64(fitted.data(), type, size, back.data(), kGdalType<T>, sizeof(T), count);
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (!has_background || !is_background(part[i])) part[i] = back[i];
    }
  }
}

/// Reads heights from a band of a VRT. GDAL works them out in the type that is asked for, and neither
/// rounds nor clamps them to the band's own.
template <class T>
void read_vrt(GDALRasterBand& band, GDALDataType own, bool has_background, const RasterShape& shape,
              const SampleRange& w, std::span<T> values, const std::string& path) {
  const bool is_integer = GDALDataTypeIsInteger(own) != 0;
  read_band(band, shape, w, values, path, is_integer ? kGdalType<T> : own);
  if (is_integer && own != kGdalType<T>) fit_to(own, has_background, values);
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
    char value[32];
    std::snprintf(value, sizeof value, "%.17g", static_cast<double>(values[i]));
    refuse(
        "the height at column " + std::to_string(column) + ", row " + std::to_string(row) +
            " (counted from 0, as stored) is infinite or as large as floats get, and so none; if "
            "such values mean no data, say so with --nodata " +
            value,
        path);
  }
}

}  // namespace

struct RasterPart::Bands : RasterBands {
  GDALDatasetUniquePtr data;
  GDALDatasetUniquePtr backed;       ///< A VRT with a background.
  GDALRasterBand* values = nullptr;  ///< The heights, where they are read.
  bool is_vrt = false;

  void look_behind(RawType raw);
};

/// Reads a VRT so that what no source covers shows.
void RasterPart::Bands::look_behind(RawType raw) {
  values = height;
  is_vrt = data->GetDriver() != nullptr && EQUAL(data->GetDriverName(), "VRT");
  backed = open_with_background(*data, background_of(raw));
  if (backed == nullptr) {
    return;
  }
  values = backed->GetRasterBand(height->GetBand());
  if (const int added = backed->GetRasterCount(); added > data->GetRasterCount()) {
    alpha = backed->GetRasterBand(added);
  }
}

RasterPart::RasterPart(std::string path, std::optional<double> nodata_override)
    : path_(std::move(path)), nodata_override_(nodata_override) {
  open();
  const GdalSession session;
  shape_ = shape_of(*bands_->data, *bands_->height, path_, warnings_);
  session.tell_warnings(path_, warnings_);
  bands_->look_behind(shape_.raw);
  const std::optional<double> declared = declared_nodata(*bands_->height);
  const std::optional<double> nodata = nodata_override_ ? nodata_override_ : declared;
  shape_.nodata = nodata;
  shape_.is_overridden = nodata_override_.has_value() && !is_same(nodata, declared);
  shape_.is_masked = bands_->mask != nullptr || bands_->alpha != nullptr;
  nodata_ = nodata_range(nodata, shape_.stored);
  if (nodata && !std::isnan(*nodata) && nodata_.is_empty()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", *nodata);
    warnings_.add({"nodata_of_another_type",
                   "no " + shape_.type_name + " is the nodata value " + text +
                       ", so no sample is void by it; say with --nodata which stored value means "
                       "no height",
                   path_});
  }
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
  SourceWarnings told;
  bands->data = open_raster(path_, told);
  const GdalSession session;
  static_cast<RasterBands&>(*bands) = bands_of(*bands->data, path_, nodata_override_.has_value());
  const bool changed = shape_.width != 0 && (bands->data->GetRasterXSize() != shape_.width ||
                                             bands->data->GetRasterYSize() != shape_.height);
  if (changed) {
    throw Error(ErrorCode::io_error, "the raster changed its size while it was read", path_);
  }
  if (shape_.width != 0) {
    bands->look_behind(shape_.raw);
  } else {
    session.tell_warnings(path_, told);
    warnings_ = std::move(told);
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
void RasterPart::sign_bytes(std::span<T> values) const {
  if (!shape_.stored.signed_bytes) return;
  std::transform(values.begin(), values.end(), values.begin(),
                 [](T v) { return v > T{127} ? v - T{256} : v; });
}

template <class T>
void RasterPart::read(const SampleRange& window, std::span<T> values,
                      std::span<std::uint8_t> valid) {
  if (!is_open()) {
    open();
  }
  if (bands_->is_vrt) {
    read_vrt(*bands_->values, bands_->height->GetRasterDataType(), bands_->backed != nullptr,
             shape_, window, values, path_);
  } else {
    read_band(*bands_->values, shape_, window, values, path_);
  }
  sign_bytes(values);
  const bool all_heights = find_valid<T>(values, valid, nodata_, shape_, bands_->backed != nullptr);
  const auto mask_out = [&]<class M>(GDALRasterBand* band, std::vector<M> mask) {
    if (band == nullptr) {
      return;
    }
    mask.resize(valid.size());
    read_band<M>(*band, shape_, window, mask, path_);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      valid[i] = static_cast<std::uint8_t>(valid[i] & (mask[i] > M{0}));
    }
  };
  mask_out(bands_->mask, std::vector<std::uint8_t>());
  mask_out(bands_->alpha, std::vector<float>());
  if (!all_heights) {  // the mask may have taken out those that are none
    check_heights<T>(window, values, valid, shape_, path_);
  }
}

template <class T>
bool RasterPart::gives_back(const SampleRange& window, std::span<const T> values,
                            std::span<const std::uint8_t> valid) {
  const double nodata = shape_.nodata.value_or(std::numeric_limits<double>::quiet_NaN());
  if (!bands_->is_vrt) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (valid[i] == 0 && !has_bits_of(values[i], nodata)) return false;
    }
    return true;
  }
  // What GDAL hands out of the VRT itself, in its own type: another value where it covers nothing, where
  // one source hides another, and by rounding.
  std::vector<T> own;
  const std::int64_t rows_at_once = std::max<std::int64_t>(1, kSamplesAtOnce / window.width);
  for (std::int64_t y = 0; y < window.height; y += rows_at_once) {
    const SampleRange strip{window.x0, window.y0 + y, window.width,
                            std::min(rows_at_once, window.height - y)};
    own.resize(static_cast<std::size_t>(strip.samples()));
    read_band<T>(*bands_->height, shape_, strip, own, path_, bands_->height->GetRasterDataType());
    sign_bytes(std::span(own));
    const auto from = static_cast<std::size_t>(y * window.width);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const bool is_same = valid[from + i] == 0
                               ? has_bits_of(own[i], nodata)
                               : std::memcmp(&own[i], &values[from + i], sizeof(T)) == 0;
      if (!is_same) return false;
    }
  }
  return true;
}

template bool RasterPart::gives_back(const SampleRange&, std::span<const std::int32_t>,
                                     std::span<const std::uint8_t>);
template bool RasterPart::gives_back(const SampleRange&, std::span<const float>,
                                     std::span<const std::uint8_t>);
template bool RasterPart::gives_back(const SampleRange&, std::span<const double>,
                                     std::span<const std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<std::int32_t>,
                               std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<float>, std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<double>, std::span<std::uint8_t>);

}  // namespace ptin
