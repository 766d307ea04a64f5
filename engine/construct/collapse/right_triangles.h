// SPDX-License-Identifier: GPL-3.0-or-later
//
// A grid of samples as right triangles within a tolerance: halved along the way from corner to
// hypotenuse, a hierarchy without cracks (Lindstrom, Koller, Ribarsky, Hodges, Faust and Turner,
// Real-time continuous level of detail rendering of height fields, 1996, bottom-up; the triangles
// are those of Evans, Kirkpatrick and Townsend, Right-triangulated irregular networks, 2001).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ptin {

/// A window of samples, row by row from the south-west.
struct SampleGrid {
  std::span<const double> codes;         ///< Height codes; of samples without one: any.
  std::span<const std::uint8_t> valid;   ///< 1 where there is a height.
  std::span<const std::uint8_t> rising;  ///< Of each cell, whether the full TIN cuts it upwards.
  std::int32_t width = 0;
  std::int32_t height = 0;

  [[nodiscard]] std::size_t at(std::int32_t x, std::int32_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Corners as numbers of samples, counter-clockwise.
using RightTriangle = std::array<std::uint32_t, 3>;

/// Which samples are needed as corners: 1 beside each that is. Of a triangle that is larger than
/// half a cell either all samples have a height, with residuals of at most `tolerance` (up to
/// rounding), or none has one. The border
/// of the window keeps all of its samples, so that windows join without cracks, and so does what
/// is left at its northern and eastern sides of squares of 32 cells.
/// Cost: linear; each sample is looked at up to ten times.
[[nodiscard]] std::vector<std::uint8_t> needed_corners(const SampleGrid& grid, double tolerance);

/// The triangles over those corners. Where both halves of a cell are there, it is cut as in the
/// full TIN. Cost: their number.
[[nodiscard]] std::vector<RightTriangle> right_triangles(const SampleGrid& grid,
                                                         std::span<const std::uint8_t> needed);

}  // namespace ptin
