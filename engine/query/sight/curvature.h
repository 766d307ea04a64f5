// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Earth's curvature, as lines of sight and viewsheds feel it.
#pragma once

namespace ptin {

/// What lies at a distance d from an observer looks lower by coefficient d^2 / diameter: GDAL's
/// convention (`gdal_viewshed -cc`, default 0.85714 = 1 - 1/7, and twice the semi-major axis),
/// which GRASS's `r.viewshed -cr` shares but for its last digits (0.14286).
struct Curvature {
  /// The share that light feels: 1 without refraction, 0 for a flat Earth; up to 1000.
  double coefficient = 0.85714;
  double earth_diameter = 2 * 6378137.0;  ///< Height's unit; > 0.

  /// How much lower a point at `distance` looks; both in the height's unit.
  [[nodiscard]] double drop_at(double distance) const noexcept {
    return drop_at_square(distance * distance);
  }
  [[nodiscard]] double drop_at_square(double distance_squared) const noexcept {
    return coefficient * distance_squared / earth_diameter;
  }
};

/// @throws Error invalid_argument when the coefficient is not in [0, 1000] or the diameter is not
/// positive
void check(const Curvature& curvature);

}  // namespace ptin
