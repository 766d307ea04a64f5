// SPDX-License-Identifier: GPL-3.0-or-later
//
// A grid of samples as right triangles within a tolerance. A triangle is halved from the right
// angle to the middle of the hypotenuse, which gives a hierarchy without cracks (Lindstrom, Koller,
// Ribarsky, Hodges, Faust and Turner, Real-time continuous level of detail rendering of height
// fields, 1996, bottom-up; the triangles are those of Evans, Kirkpatrick and Townsend,
// Right-triangulated irregular networks, 2001).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ptin {

/// A window of samples, row by row from the south-west.
struct SampleGrid {
  std::span<const double> codes;         ///< Height codes; any value without a height.
  std::span<const std::uint8_t> valid;   ///< 1 where there is a height.
  std::span<const std::uint8_t> rising;  ///< 1 where the full TIN cuts a cell upwards.
  std::int32_t width = 0;
  std::int32_t height = 0;

  /// Number of the sample in column x, row y. A cell has the number of its south-western sample.
  [[nodiscard]] std::size_t at(std::int32_t x, std::int32_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// The corners, as numbers of samples; counter-clockwise.
using RightTriangle = std::array<std::uint32_t, 3>;

/// For each sample 1 where it is needed as a corner, else 0. Of a triangle that is larger than half
/// a cell either all samples have a height and residuals of at most `tolerance` (up to rounding),
/// or none has a height. The border of the window keeps all of its samples, so that windows join
/// without cracks. The rest at the northern and eastern sides that squares of 32 cells leave
/// uncovered keeps all of its samples too.
/// @param tolerance  In height codes.
/// Cost: linear; each sample is looked at up to ten times.
[[nodiscard]] std::vector<std::uint8_t> needed_corners(const SampleGrid& grid, double tolerance);

/// The triangles over these corners. Where both halves of a cell are there, the cell is cut as in
/// the full TIN. Cost: their number.
/// @param needed  As needed_corners() returns it.
[[nodiscard]] std::vector<RightTriangle> right_triangles(const SampleGrid& grid,
                                                         std::span<const std::uint8_t> needed);

}  // namespace ptin
