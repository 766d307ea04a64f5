// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/decimal_steps.h"

#include <cmath>

namespace ptin::tools {

__extension__ using Wide = __int128;

double steps_of(Decimal d, double origin, double step) {
  const double digits = std::round(-std::log10(step));
  const bool is_decimal = digits >= 0 && digits < 16 &&
                          std::abs(step * std::pow(10.0, digits) - 1.0) < 1e-12 &&
                          std::abs(origin / step - std::round(origin / step)) < 1e-3;
  if (!is_decimal) return std::round((to_double(d) - origin) / step);
  Wide m = d.mantissa;
  const bool is_negative = m < 0;
  m = is_negative ? -m : m;
  for (; d.decimals > digits + 1; --d.decimals) m /= 10;  // below the digit that decides
  if (d.decimals > digits) m = (m + 5) / 10, --d.decimals;
  for (; d.decimals < digits; ++d.decimals) m *= 10;
  return static_cast<double>(is_negative ? -m : m) - std::round(origin / step);
}

MapPoint grid_position(const SourcePoint& p, const AffineMap& map,
                       std::optional<double> resolution) {
  if (!resolution) {
    return {steps_of(p.x, map.origin_x, map.step_x), steps_of(p.y, map.origin_y, map.step_y)};
  }
  const auto from_zero = [&](double value) { return std::round(value / *resolution); };
  return {from_zero(to_double(p.x)) - from_zero(map.origin_x),
          from_zero(to_double(p.y)) - from_zero(map.origin_y)};
}

}  // namespace ptin::tools
