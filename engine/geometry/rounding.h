// SPDX-License-Identifier: GPL-3.0-or-later
//
// Outward rounding of certified bounds.
#pragma once

#include <cmath>
#include <limits>

namespace ptin {

/// The least float32 not below `bound`. REQUIRES: bound >= 0 or +infinity. 0 stays 0.
[[nodiscard]] inline float rounded_up(double bound) noexcept {
  const auto f = static_cast<float>(bound);
  return static_cast<double>(f) >= bound
             ? f
             : std::nextafter(f, std::numeric_limits<float>::infinity());
}

}  // namespace ptin
