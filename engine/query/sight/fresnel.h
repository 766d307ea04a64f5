// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first Fresnel zone over one stretch of a line.
#pragma once

namespace ptin {

/// Where clearance(s) / sqrt(s (1 - s)) is least over [from, to], for the convex parabola that has
/// the values `c_from` and `c_to` at the ends and the leading coefficient `bend`. The ends of the
/// whole line (shares 0 and 1) have no zone: there the ratio is the limit from inside.
struct LeastRatio {
  double ratio;  ///< Infinite when there is no inner point.
  double at;
};
[[nodiscard]] LeastRatio least_fresnel_ratio(double from, double c_from, double to, double c_to,
                                             double bend);

}  // namespace ptin
