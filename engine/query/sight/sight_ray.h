// SPDX-License-Identifier: GPL-3.0-or-later
//
// The line between two ends as a function of the share of the way, in doubles with bounds and in
// rationals.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Least value of the convex parabola with leading coefficient `bend` >= 0 through (s0, v0) and
/// (s1, v1), between these points.
struct Lowest {
  double value;
  double at;  ///< Where, as s.
};
[[nodiscard]] inline Lowest lowest_between(double s0, double v0, double s1, double v1,
                                           double bend) noexcept {
  const Lowest ends = v0 <= v1 ? Lowest{v0, s0} : Lowest{v1, s1};
  const double width = s1 - s0;
  if (!(bend * width > 0)) {
    return ends;
  }
  const double at = (s0 + s1) / 2 - (v1 - v0) / (2 * bend * width);
  if (!(at > s0 && at < s1)) {
    return ends;
  }
  return {std::min(v0 - bend * (at - s0) * (at - s0), ends.value), at};
}

/// Where the convex parabola with leading coefficient `bend` >= 0 through (0, v0) and (1, v1) first
/// falls to zero: 0 where it begins below, and where it does not fall so far.
[[nodiscard]] inline double first_zero(double v0, double v1, double bend) noexcept {
  const double slope = v1 - v0 - bend;
  const double root = std::sqrt(std::max(0.0, slope * slope - 4 * bend * v0));
  return v0 > 0 && root - slope > 0 ? std::min(1.0, 2 * v0 / (root - slope)) : 0.0;
}

/// Heights of the line at share s of the way: z(s) = z_a + s (z_b - z_a) - bend s (1 - s), where
/// the heights of the ends are known within intervals.
struct Ray {
  Interval a, b;      ///< Heights of the ends, height's unit.
  double bend = 0.0;  ///< Curvature::drop_at(length).

  [[nodiscard]] double low(double s) const noexcept { return at(a.lo, b.lo, s); }
  [[nodiscard]] double high(double s) const noexcept { return at(a.hi, b.hi, s); }
  [[nodiscard]] double middle(double s) const noexcept { return (low(s) + high(s)) / 2; }
  /// Lower bound of the heights between two shares.
  [[nodiscard]] double lowest(double s0, double s1) const noexcept {
    return lowest_between(s0, low(s0), s1, low(s1), bend).value;
  }
  [[nodiscard]] bool is_known() const noexcept { return a.lo == a.hi && b.lo == b.hi; }

 private:
  [[nodiscard]] double at(double za, double zb, double s) const noexcept {
    // An end of which nothing is known counts as high as the other end.
    return std::isfinite(za) && std::isfinite(zb) ? za * (1 - s) + zb * s - bend * s * (1 - s)
                                                  : (std::isfinite(za) ? zb : za);
  }
};

/// An end, for exact comparisons: `height` above the ground, or absolute.
struct ExactEnd {
  double height = 0.0;
  const WeightedCodes* ground = nullptr;  ///< Borrowed. Null: absolute.
};

/// Decides in rationals what doubles cannot.
class ExactRay {
 public:
  ExactRay(const HeightEncoding& heights, const ExactEnd& a, const ExactEnd& b, double bend)
      : heights_(heights), a_(a), b_(b), bend_(bend) {}

  /// Sign of the line's height above the surface at a point. REQUIRES: there is surface.
  [[nodiscard]] int sign_at(const LinePoint& at) const;
  /// Sign of the line's least height above the surface over a stretch on which the surface is
  /// straight, ends included. REQUIRES: as sign_at().
  [[nodiscard]] int sign_over(const LinePoint& from, const LinePoint& to) const;

 private:
  HeightEncoding heights_;
  ExactEnd a_, b_;
  double bend_;
};

}  // namespace ptin
