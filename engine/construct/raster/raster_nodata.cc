// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_nodata.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>

#include "engine/number.h"

namespace ptin {
namespace {

/// No height is as large as this; what is declared to be so large was written with few digits.
constexpr double kHuge = 1e30;
constexpr double kHugeSlack = 1e-3;
/// Beyond the largest float, whatever digits it was written with.
constexpr double kBeyondFloat = 3.41e38;
/// The largest float of 16 bits.
constexpr double kLargestHalf = 65504.0;

template <class T>
NodataRange if_held(double value) {
  const bool is_held = value >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
                       value <= static_cast<double>(std::numeric_limits<T>::max()) &&
                       value == std::trunc(value);
  return is_held ? NodataRange{value, value} : NodataRange{};
}

float as_float(double value) {
  return static_cast<float>(std::clamp(value, -double{FLT_MAX}, double{FLT_MAX}));
}

/// The values on either side that have so many significant bits, or the value itself.
NodataRange rounded_to(double value, int bits) {
  int exponent = 0;
  const double mantissa = std::ldexp(std::frexp(value, &exponent), bits);
  return {std::ldexp(std::floor(mantissa), exponent - bits),
          std::ldexp(std::ceil(mantissa), exponent - bits)};
}

NodataRange range_of_floats(double value, const StoredType& stored) {
  const double infinite = std::copysign(std::numeric_limits<double>::infinity(), value);
  const auto up_to_infinite = [&](double from) {
    return NodataRange{std::min(from, infinite), std::max(from, infinite)};
  };
  if (std::isinf(value)) {
    return {value, value};
  }
  const bool is_half = stored.significant_bits > 0 && stored.significant_bits <= 11;
  if (is_half && std::abs(value) > kLargestHalf) {
    return up_to_infinite(std::copysign(kLargestHalf, value));
  }
  if (stored.type == GDT_Float32 && std::abs(value) >= kBeyondFloat) {
    return up_to_infinite(std::copysign(double{FLT_MAX}, value));
  }
  if (std::abs(value) >= kHuge) {
    const double a = value * (1.0 - kHugeSlack);
    const double b = std::clamp(value * (1.0 + kHugeSlack), -DBL_MAX, DBL_MAX);
    return {std::min(a, b), std::max(a, b)};
  }
  if (stored.significant_bits > 0) {
    return rounded_to(value, stored.significant_bits);
  }
  const double single = as_float(value);
  return stored.type == GDT_Float32 ? NodataRange{single, single}
                                    : NodataRange{std::min(single, value), std::max(single, value)};
}

}  // namespace

NodataRange nodata_range(std::optional<double> nodata, const StoredType& stored) {
  if (!nodata || std::isnan(*nodata)) {
    return {};
  }
  switch (stored.type) {
    case GDT_Byte:
      return stored.signed_bytes ? if_held<std::int8_t>(*nodata) : if_held<std::uint8_t>(*nodata);
    case GDT_UInt16:
      return if_held<std::uint16_t>(*nodata);
    case GDT_Int16:
      return if_held<std::int16_t>(*nodata);
    case GDT_UInt32:
      return if_held<std::uint32_t>(*nodata);
    case GDT_Int32:
      return if_held<std::int32_t>(*nodata);
    case GDT_UInt64:
      return if_held<std::uint64_t>(*nodata);
    case GDT_Int64:
      return if_held<std::int64_t>(*nodata);
    case GDT_Float32:
    case GDT_Float64:
      return range_of_floats(*nodata, stored);
    default:  // Int8, which GDAL has from 3.7 on
      return if_held<std::int8_t>(*nodata);
  }
}

int significant_bits_of(GDALDataType type, const char* nbits) {
  if (type != GDT_Float32 || nbits == nullptr) {
    return 0;
  }
  const int bits = parse_number<int>(nbits).value_or(0);
  return bits == 16 ? 11 : bits == 24 ? 17 : 0;
}

}  // namespace ptin
