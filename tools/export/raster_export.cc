// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/raster_export.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/memory_units.h"
#include "tools/export/pixel_grid.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

namespace {

/// Checks that a block fits the memory of the question, which samples whole blocks.
void check_block(const RasterRequest& request, const RasterTarget& target) {
  const std::int64_t width = std::min(request.block_width, request.pixels.width);
  const std::int64_t height = std::min(request.block_height, request.pixels.height);
  const std::uint64_t bytes = static_cast<std::uint64_t>(width * height) *
                              (request.heights ? sizeof(double) : sizeof(GridNormal));
  if (bytes <= request.limits.memory_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "a block of " + std::to_string(width) + " x " + std::to_string(height) +
                  " pixels takes " + std::to_string((bytes - 1) / kMiB + 1) +
                  " MiB of memory, and " + std::to_string(request.limits.memory_bytes / kMiB) +
                  " MiB are there for it; give smaller blocks (--co BLOCKXSIZE=" + kBlockSide +
                  " --co BLOCKYSIZE=" + kBlockSide + ") or more --memory",
              target.path);
}

/// Numbers of a type of pixels; heights between them are rounded to the nearest, halves away from 0.
template <class T>
struct Rounding {
  static constexpr double kLow = static_cast<double>(std::numeric_limits<T>::lowest());
  static constexpr double kHigh = static_cast<double>(std::numeric_limits<T>::max());
  [[nodiscard]] static bool holds(double height) noexcept {
    return std::is_floating_point_v<T> || (height > kLow - 0.5 && height < kHigh + 0.5);
  }
  [[nodiscard]] static T of(double height) noexcept {
    if constexpr (std::is_floating_point_v<T>) return static_cast<T>(height);
    return static_cast<T>(height + (height < 0 ? -0.5 : 0.5));
  }
};

/// The sum of two bounds, rounded up.
double sum_above(double a, double b) {
  return a == 0 || b == 0 ? a + b : std::nextafter(a + b, HUGE_VAL);
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return "inf";
  std::string text;
  append_number(text, value);
  return text;
}

void describe(RasterFile& file, const WrittenRaster& written) {
  file.describe("PTIN_CERTIFIED_ERROR", number_text(written.certified_error));
  file.describe("PTIN_CERTIFIED_DEVIATION", number_text(written.certified_deviation));
  file.describe("PTIN_EXACT", written.exact ? "true" : "false");
}

/// Fills a raster block by block.
class RasterWriter {
 public:
  /// @param request  What is not asked for yet is set.
  /// @throws Error resource_exhausted  a block does not fit the memory
  RasterWriter(const Terrain& terrain, RasterRequest request, const RasterTarget& target,
               RasterFile& file)
      : terrain_(terrain),
        request_(std::move(request)),
        target_(target),
        file_(file),
        type_(file.band().GetRasterDataType()),
        per_map_unit_(ground_of(target.crs).per_map_unit) {
    int width = 0;
    int height = 0;
    file.band().GetBlockSize(&width, &height);
    request_.block_width = width;
    request_.block_height = height;
    request_.heights = of_heights();
    request_.normals = !of_heights();
    check_block(request_, target);
  }

  WrittenRaster run() {
    const RasterResult result =
        terrain_.raster(request_, [this](const RasterBlock& block) { write(block); });
    return {rounding_,
            result.surface_pixels,
            sum_above(result.certified_error, rounding_),
            sum_above(result.certified_deviation, rounding_),
            result.exact && rounding_ == 0,
            result.cost};
  }

 private:
  [[nodiscard]] bool of_heights() const { return target_.content.value == PixelValue::kHeight; }

  void write(const RasterBlock& block) {
    if (type_ == GDT_Float64) return write_as<double>(block);
    if (type_ == GDT_Byte) return write_as<std::uint8_t>(block);
    if (type_ == GDT_Int16) return write_as<std::int16_t>(block);
    if (type_ == GDT_Int32) return write_as<std::int32_t>(block);
    write_as<float>(block);
  }

  template <typename T>
  void write_as(const RasterBlock& block) {
    const PixelRect& pixels = block.pixels;
    const auto width = static_cast<std::size_t>(request_.block_width);
    const auto nodata = static_cast<T>(target_.nodata);
    bytes_.resize(width * static_cast<std::size_t>(request_.block_height) * sizeof(T));
    const std::span<T> values(reinterpret_cast<T*>(bytes_.data()), bytes_.size() / sizeof(T));
    if (pixels.width < request_.block_width || pixels.height < request_.block_height) {
      std::fill(values.begin(), values.end(), nodata);
    }
    for (std::int64_t y = 0; y < pixels.height; ++y) {
      const std::size_t from = static_cast<std::size_t>(y) * block.stride;
      const auto to = values.subspan(static_cast<std::size_t>(y) * width,
                                     static_cast<std::size_t>(pixels.width));
      if (of_heights()) {
        take_heights<T>({block.heights + from, to.size()}, nodata, to);
        continue;
      }
      for (std::size_t x = 0; x < to.size(); ++x) {
        const auto value = value_of(block.normals[from + x],
                                    pixels.column + static_cast<std::int64_t>(x), pixels.row + y);
        to[x] = value ? static_cast<T>(*value) : nodata;
      }
    }
    file_.write_block(
        static_cast<int>((pixels.column - request_.pixels.column) / request_.block_width),
        static_cast<int>((pixels.row - request_.pixels.row) / request_.block_height),
        values.data());
  }

  /// Rounds a row of heights to the type of the pixels.
  template <class T>
  void take_heights(std::span<const double> heights, T nodata, std::span<T> to) {
    double rounding = rounding_;
    bool fits = true, is_lost = false;
    for (std::size_t x = 0; x < to.size(); ++x) {
      const double height = heights[x];
      const bool is_height = height == height;
      const bool holds = is_height && Rounding<T>::holds(height);
      fits = fits && (holds || !is_height);
      const T rounded = holds ? Rounding<T>::of(height) : nodata;
      is_lost = is_lost || (holds && rounded == nodata);
      // Exact: the two numbers are nearly the same.
      const double off = holds ? std::abs(static_cast<double>(rounded) - height) : 0.0;
      rounding = off > rounding ? off : rounding;
      to[x] = rounded;
    }
    rounding_ = rounding;
    if (!fits) refuse_type(heights);
    if (is_lost) refuse_nodata();
  }
  [[noreturn]] void refuse_nodata() const {
    std::string message = "a pixel has the height ";
    append_number(message, target_.nodata);
    throw Error(ErrorCode::invalid_argument,
                message +
                    ", which --nodata says of pixels without surface: give it a number that "
                    "no height is",
                target_.path);
  }
  [[noreturn]] void refuse_type(std::span<const double> heights) const {
    const auto off = std::find_if(heights.begin(), heights.end(), [&](double h) {
      return h == h && !(type_ == GDT_Int16 ? Rounding<std::int16_t>::holds(h)
                                            : Rounding<std::int32_t>::holds(h));
    });
    throw Error(ErrorCode::invalid_argument,
                "a height of " + std::to_string(*off) + " does not fit " +
                    GDALGetDataTypeName(type_) + "; leave --type out, or give one that holds it",
                target_.path);
  }

  [[nodiscard]] std::optional<double> value_of(const GridNormal& normal, std::int64_t column,
                                               std::int64_t row) const {
    return value_at(normal, target_.content, terrain_.store().facts(),
                    per_map_unit_(request_.lattice.centre(column, row)));
  }

  const Terrain& terrain_;
  RasterRequest request_;
  const RasterTarget& target_;
  RasterFile& file_;
  const GDALDataType type_;
  std::function<MapPoint(MapPoint)> per_map_unit_;
  double rounding_ = 0.0;
  std::vector<std::byte> bytes_;  ///< Of the values of a block.
};

}  // namespace

WrittenRaster export_raster(const Terrain& terrain, RasterRequest request,
                            const RasterTarget& target,
                            const std::function<void(double)>& progress) {
  RasterForm form;
  form.width = request.pixels.width;
  form.height = request.pixels.height;
  form.type = target.type.value_or(type_of_pixels(terrain.store().facts(), target.content.value));
  form.geotransform = geotransform_of(request);
  form.nodata = target.nodata;
  form.unit = unit_of_pixels(target.content, target.crs);
  RasterFile file(target, form);
  const double share = target.is_cog ? 0.5 : 1.0;
  request.progress = [&](double done) {
    if (progress) progress(done * share);
  };
  const WrittenRaster written = RasterWriter(terrain, request, target, file).run();
  if (target.is_described) describe(file, written);
  file.publish(progress, request.limits.stop);
  return written;
}

}  // namespace ptin::tools
