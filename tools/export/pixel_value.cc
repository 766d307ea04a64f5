// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/pixel_value.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ptin::tools {

GDALDataType type_of_pixels(const StoreFacts& facts, PixelValue value) {
  if (value == PixelValue::kHillshade) return GDT_Byte;
  if (value != PixelValue::kHeight) return GDT_Float32;
  const HeightEncoding& heights = facts.heights;
  if (heights.type != HeightType::int32) return GDT_Float32;
  // Float32 holds whole multiples of a power of two that take at most 24 bits; it does not hold
  // tenths.
  int exponent = 0;
  const bool is_power = std::frexp(heights.step, &exponent) == 0.5;
  const double steps_to_offset = heights.offset / heights.step;
  const double largest = std::max(std::abs(facts.min_height), std::abs(facts.max_height));
  const bool fits = is_power && steps_to_offset == std::trunc(steps_to_offset) &&
                    largest / heights.step <= 0x1p24;
  return fits ? GDT_Float32 : GDT_Float64;
}

bool may_be_pixel(const StoreFacts& facts, double number,
                  std::optional<GDALDataType> type) noexcept {
  // Heights beside it are rounded to it where pixels are whole.
  const double off = type && GDALDataTypeIsInteger(*type) ? 0.5 : 0.0;
  return facts.min_height - off <= number && number <= facts.max_height + off;
}

double default_nodata(const StoreFacts& facts, PixelValue value,
                      std::optional<GDALDataType> type) noexcept {
  constexpr double kUsual = -9999.0;
  if (value == PixelValue::kHillshade) return 0.0;
  if (value != PixelValue::kHeight || !may_be_pixel(facts, kUsual, type)) return kUsual;
  using Short = std::numeric_limits<std::int16_t>;
  using Int = std::numeric_limits<std::int32_t>;
  if (type == GDT_Int16)
    return may_be_pixel(facts, Short::lowest(), type) ? Short::max() : Short::lowest();
  if (type == GDT_Int32)
    return may_be_pixel(facts, Int::lowest(), type) ? Int::max() : Int::lowest();
  return static_cast<double>(std::numeric_limits<float>::lowest());
}

std::string unit_of_pixels(const PixelContent& content, const CrsFacts& crs) {
  switch (content.value) {
    case PixelValue::kHeight:
      return crs.vertical_unit == "unknown" ? "" : crs.vertical_unit;
    case PixelValue::kSlope:
      return content.in_percent ? "percent" : "degree";
    case PixelValue::kAspect:
      return "degree";
    case PixelValue::kHillshade:
      break;
  }
  return {};
}

std::optional<double> value_at(const GridNormal& normal, const PixelContent& content,
                               const StoreFacts& facts, MapPoint per_map_unit) {
  if (!(normal.z > 0)) return std::nullopt;
  const Slope slope = slope_of(normal, facts, per_map_unit);
  if (content.value == PixelValue::kAspect) return aspect_of(slope);
  if (content.value == PixelValue::kHillshade) return grey_of(content.light.on(slope));
  return content.in_percent ? percent_of(slope) : degrees_of(slope);
}

}  // namespace ptin::tools
