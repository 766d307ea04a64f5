// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_digits.h"

#include <algorithm>

#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/source_point.h"
#include "engine/geometry/point.h"

namespace ptin {

namespace {

/// Exact but for one rounding to 64 bits.
long double value_of(Decimal d) noexcept {
  return static_cast<long double>(d.mantissa) / std::pow(10.0L, d.decimals);
}

/// Rounds `value` as drop_digits() does; returns the value before less the value after.
double round_to(Decimal& value, int decimals) noexcept {
  if (value.decimals <= decimals) {
    return 0.0;
  }
  const long double before = value_of(value);
  for (; value.decimals > decimals + 1; --value.decimals) {
    value.mantissa /= 10;
  }
  const std::int64_t last = value.mantissa % 10;
  value.mantissa = value.mantissa / 10 + (last >= 5 ? 1 : (last <= -5 ? -1 : 0));
  --value.decimals;
  for (; value.decimals > 0 && value.mantissa % 10 == 0; --value.decimals) {
    value.mantissa /= 10;
  }
  return static_cast<double>(before - value_of(value));
}

}  // namespace

void TinDigits::add(const SourcePoint& p) noexcept {
  const std::array<Decimal, 2> numbers{p.x, p.y};
  for (std::size_t i = 0; i < 2; ++i) {
    const double value = to_double(numbers[i]);
    axes_[i].low = std::min(axes_[i].low, value);
    axes_[i].high = std::max(axes_[i].high, value);
    decimals_ = std::max(decimals_, static_cast<int>(numbers[i].decimals));
  }
}

int TinDigits::kept() const noexcept {
  constexpr double kRoom = 4.0;  // so that rounding cannot exceed the grid
  const auto fits = [&](int decimals) {
    const double step = decimal_step(decimals);
    return std::all_of(axes_.begin(), axes_.end(), [&](const Axis& a) {
      return (a.high - a.low) / step <= kGridMax - kRoom &&
             std::max(std::abs(a.low), std::abs(a.high)) / step <= kMostStepsFromZero;
    });
  };
  int decimals = decimals_;
  while (decimals > 0 && !fits(decimals)) {
    --decimals;
  }
  return decimals;
}

DroppedDigits drop_digits(SourcePoint& p, int decimals) noexcept {
  const double x = round_to(p.x, decimals);
  return {x, round_to(p.y, decimals)};
}

}  // namespace ptin
