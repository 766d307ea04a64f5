// SPDX-License-Identifier: GPL-3.0-or-later
//
// Residuals of samples against a fan: the inner loop of construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/measure/star_samples.h"

namespace ptin {

/// The fan of a collapse into w. Spokes go from w to the other link vertices in their order, and
/// triangle i lies between spokes i and i + 1. Grid units and height codes.
struct FanFrame {
  std::size_t j = 0;                       ///< w is link[j] of the star.
  double w_x = 0.0, w_y = 0.0, w_z = 0.0;  ///< w relative to u.
  // Buffers. Those of doubles may be longer than what is used of them.
  std::vector<double> spoke_x, spoke_y, spoke_z;  ///< Relative to w; one more than triangles.
  std::vector<double> determinant, inverse;  ///< Twice the area of each triangle, and its inverse.
  /// For each fan triangle: the index in the star of the triangle that it replaces.
  std::vector<std::uint32_t> star_triangle;
  std::vector<unsigned char> is_surface;  ///< 1 or 0; measure_with_voids() alone fills it.

  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }
  void set_triangles(std::size_t n) {
    triangles_ = n;
    if (n >= spoke_x.size()) {
      for (std::vector<double>* buffer : {&spoke_x, &spoke_y, &spoke_z, &determinant, &inverse}) {
        buffer->resize(2 * n + 1);
      }
    }
    star_triangle.resize(n);
  }

 private:
  std::size_t triangles_ = 0;
};

/// The cross product of two vectors with integer coordinates below 2^31, exactly.
[[nodiscard]] inline std::int64_t cross_exact(double ax, double ay, double bx, double by) noexcept {
  return static_cast<std::int64_t>(ax) * static_cast<std::int64_t>(by) -
         static_cast<std::int64_t>(ay) * static_cast<std::int64_t>(bx);
}

/// Builds the frame of the fan from link[j]. Returns false when the collapse is not allowed, by the
/// same rule as can_collapse(): a fan triangle would not be strictly counter-clockwise, or u is on
/// the border and w is not a collinear neighbour along it.
[[nodiscard]] bool make_fan(const StarSamples& s, std::size_t j, FanFrame& fan);

/// Builds the frame of the star itself: u takes the place of w, and triangle i is triangle i of the
/// star.
void make_spokes_of_star(const StarSamples& s, FanFrame& fan);

/// Largest |vertical distance|, in height codes, between each of the samples [begin, end) and the
/// fan triangle that it lies in. Returns early, with the largest so far, once that exceeds
/// `stop_above`.
/// @param begin, end  Multiples of kSampleLanes.
/// Rounding: see residual_bound().
[[nodiscard]] double largest_residual(const StarSamples& s, const FanFrame& fan, std::size_t begin,
                                      std::size_t end, double stop_above) noexcept;

/// Gives for each sample, padding included, the number of the fan triangle that it lies in and its
/// |vertical distance| to it. A sample on a spoke goes to either side: the planes agree there.
void assign_samples(const StarSamples& s, const FanFrame& fan, std::vector<double>& triangle,
                    std::vector<double>& residual);

/// What to add to a residual of the star, in height codes, so that it bounds the true one. 0 when
/// the arithmetic was exact but for the final division, whose rounding scaled_up() covers.
///
/// A residual is |D dz + z_i c_{i+1} - z_{i+1} c_i| / D. Inside of the triangle |c| <= D, and |z|
/// <= 2 Z with Z = largest_z. With integer codes and 12 * (2 * 2 R)^2 * 2 Z below 2^53 (R =
/// largest_xy) every product and sum is an integer below 2^53, thus exact. Otherwise each of the
/// three products and two sums is off by at most 2^-53 times 6 D Z, and differences of codes by
/// 2^-53 times 4 Z each: together below 2^-53 * 50 Z, rounded up here to 2^-47 Z.
[[nodiscard]] double residual_bound(const StarSamples& s, const MeasureUnits& units) noexcept;

/// A residual raised by its relative rounding: two roundings of at most 2^-53 each (inverse,
/// product).
[[nodiscard]] inline double scaled_up(double residual) noexcept {
  return residual * (1.0 + 0x1p-50);
}

/// The largest residual of a star as a bound: raised by its rounding and by residual_bound().
/// Where the arithmetic is in integers, a residual that comes out as an integer m is m, and is not
/// raised. For it is a quotient n / D with D <= 8 R^2 (R = largest_xy); a quotient that is not m
/// differs from m by at least 1 / D, which is more than the rounding while D m < 2^48. So on data
/// in whole units an error of exactly 5 is left out at a tolerance of 5.
[[nodiscard]] double certified_residual(double residual, const StarSamples& s,
                                        const MeasureUnits& units) noexcept;

/// Decides exactly whether every sample lies on the plane of its fan triangle: in 128-bit integers,
/// with codes scaled to integers. False also where the star has blocks or its codes span more than
/// 60 bits: such a star is given a tiny error instead of 0.
/// REQUIRES: gather_sources() was called.
[[nodiscard]] bool all_residuals_zero(const Tile& tile, const StarSamples& s, const FanFrame& fan);

}  // namespace ptin
