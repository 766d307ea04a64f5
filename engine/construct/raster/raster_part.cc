// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_part.h"

#include <algorithm>
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

std::string background_of(RawType raw) {
  return raw == RawType::kInt32 ? std::to_string(kBackground) : "nan";
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
      is_value = is_value && !(has_background && v == kBackground);
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

  void look_behind(RawType raw);
};

/// Reads a VRT so that what no source covers shows.
void RasterPart::Bands::look_behind(RawType raw) {
  values = height;
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
void RasterPart::read(const SampleRange& window, std::span<T> values,
                      std::span<std::uint8_t> valid) {
  if (!is_open()) {
    open();
  }
  read_band(*bands_->values, shape_, window, values, path_);
  if (shape_.stored.signed_bytes) {
    std::transform(values.begin(), values.end(), values.begin(),
                   [](T v) { return v > T{127} ? v - T{256} : v; });
  }
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
bool RasterPart::are_voids_alike(std::span<const T> values,
                                 std::span<const std::uint8_t> valid) const {
  // GDAL hands out the nodata value where a VRT has no source, and 0 where it has no such value either.
  const bool has_background = std::is_integral_v<T> && shape_.nodata.has_value();
  const double nodata = shape_.nodata.value_or(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_alike = valid[i] != 0 || has_bits_of(values[i], nodata) ||
                          (has_background && static_cast<double>(values[i]) == kBackground);
    if (!is_alike) return false;
  }
  return true;
}

template bool RasterPart::are_voids_alike(std::span<const std::int32_t>,
                                          std::span<const std::uint8_t>) const;
template bool RasterPart::are_voids_alike(std::span<const float>,
                                          std::span<const std::uint8_t>) const;
template bool RasterPart::are_voids_alike(std::span<const double>,
                                          std::span<const std::uint8_t>) const;
template void RasterPart::read(const SampleRange&, std::span<std::int32_t>,
                               std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<float>, std::span<std::uint8_t>);
template void RasterPart::read(const SampleRange&, std::span<double>, std::span<std::uint8_t>);

}  // namespace ptin
