// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first Fresnel zone over one stretch of a line.
#pragma once

namespace ptin {

/// Where clearance(s) / sqrt(s (1 - s)) is least for shares s of the way in [from, to]. The
/// clearance is the convex parabola that has the values `c_from` and `c_to` at the ends and the
/// leading coefficient `bend`. The ends of the whole line (shares 0 and 1) are left out, since the
/// zone has no width there. REQUIRES: from < to.
struct LeastRatio {
  double ratio;  ///< Infinite when [from, to] has no inner point of the line.
  double at;     ///< Share of the way.
};
[[nodiscard]] LeastRatio least_fresnel_ratio(double from, double c_from, double to, double c_to,
                                             double bend);

}  // namespace ptin
