// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bounds of a curve of which samples are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace ptin::tools {

/// A closed range; empty when low > high.
struct CurveRange {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;

  /// Extends the range by a smooth function, or one with a kink, of which samples at equal steps are
  /// known. Between two samples f leaves the line through them by at most max |f''| h^2 / 8, which is
  /// an eighth of a second difference, and by less than half of one of the two second differences
  /// where it has one kink; half of the larger one is added. Exact where f is a straight line.
  void hold_curve(std::span<const double> samples) noexcept {
    const auto bend = [&](std::size_t i) {
      if (samples.size() < 3) return 0.0;
      i = std::clamp<std::size_t>(i, 1, samples.size() - 2);
      return std::abs(samples[i - 1] - 2 * samples[i] + samples[i + 1]);
    };
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
      const double beyond = std::max(bend(i), bend(i + 1)) / 2;
      const double a = samples[i], b = samples[i + 1];
      // A bend within the rounding of the samples is none.
      const double slack = beyond > 1e-12 * (std::abs(a) + std::abs(b)) ? beyond : 0.0;
      low = std::min(low, std::min(a, b) - slack);
      high = std::max(high, std::max(a, b) + slack);
    }
  }
};

}  // namespace ptin::tools
