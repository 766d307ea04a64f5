// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/fresnel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// c(s) = constant + slope s + bend s^2.
struct Parabola {
  double constant, slope, bend;
  [[nodiscard]] double at(double s) const { return constant + s * (slope + s * bend); }
};

Parabola through(double from, double c_from, double to, double c_to, double bend) {
  const double slope = (c_to - c_from) / (to - from) - bend * (from + to);
  return {c_from - from * (slope + from * bend), slope, bend};
}

/// Numerator of the derivative of c(s) / sqrt(s (1 - s)), which has its sign for 0 < s < 1:
/// c'(s) s (1 - s) - c(s) (1 - 2 s) / 2.
double slope_sign(const Parabola& c, double s) {
  return (c.slope + 2 * c.bend * s) * s * (1 - s) - c.at(s) * (1 - 2 * s) / 2;
}

/// A change of sign between two shares, by halving.
double sign_change(const Parabola& c, double low, double high) {
  const bool rising = slope_sign(c, low) < 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((slope_sign(c, middle) < 0) == rising ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

LeastRatio least_fresnel_ratio(double from, double c_from, double to, double c_to, double bend) {
  LeastRatio least{kInfinity, from};
  const Parabola c = through(from, c_from, to, c_to, bend);
  const auto consider = [&](double s) {
    if (s > 0 && s < 1) {
      const double ratio = c.at(s) / std::sqrt(s * (1 - s));
      if (ratio < least.ratio) {
        least = {ratio, s};
      }
    }
  };
  // The numerator is a cubic, -bend s^3 + 3/2 bend s^2 + (constant + slope / 2) s - constant / 2:
  // it is monotone between the roots of its derivative.
  std::array<double, 4> cuts{from, from, to, to};
  if (bend != 0) {
    const double inside = 0.25 + (c.constant + c.slope / 2) / (3 * bend);
    if (inside > 0) {
      cuts[1] = std::clamp(0.5 - std::sqrt(inside), from, to);
      cuts[2] = std::clamp(0.5 + std::sqrt(inside), from, to);
      std::sort(cuts.begin(), cuts.end());
    }
  }
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    consider(cuts[i]);
    if ((slope_sign(c, cuts[i]) < 0) != (slope_sign(c, cuts[i + 1]) < 0)) {
      consider(sign_change(c, cuts[i], cuts[i + 1]));
    }
  }
  consider(to);
  return least;
}

}  // namespace ptin
