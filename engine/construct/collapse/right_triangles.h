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

/// A window with what lies around it, as far as there is any.
struct SurroundedGrid {
  SampleGrid window;
  SampleGrid around;          ///< Holds the window. `rising` is not asked for.
  std::int32_t x = 0, y = 0;  ///< The window's first sample in `around`: multiples of 16.
};

/// As far beyond a side of the window, samples decide which corners on it are needed.
inline constexpr std::int32_t kDecidingMargin = 16;

/// For each sample of the window 1 where it is needed as a corner, else 0. In a triangle that is
/// larger than half a cell either all samples have a height and residuals of at most `tolerance` (up
/// to rounding), or none has a height. So that windows join without cracks, a side of the window
/// keeps its samples where nothing lies around it. Else it keeps every eighth, and of the others those
/// that are needed on either side of it: of these the window beyond, whose surroundings hold the same
/// samples, decides the same. The rest at the northern and eastern sides that squares of 32 cells
/// leave uncovered keeps all of its samples.
/// REQUIRES: where samples lie around a side they reach kDecidingMargin beyond it, the window's places
/// in the raster are multiples of 16, and it has more than 32 samples a side.
/// @param tolerance  In height codes.
/// Cost: linear; each sample is looked at up to ten times.
[[nodiscard]] std::vector<std::uint8_t> needed_corners(const SurroundedGrid& grid,
                                                       double tolerance);

/// The triangles over these corners. Where both halves of a cell are there, the cell is cut as in
/// the full TIN. Cost: their number.
/// @param needed  As needed_corners() returns it.
[[nodiscard]] std::vector<RightTriangle> right_triangles(const SampleGrid& grid,
                                                         std::span<const std::uint8_t> needed);

}  // namespace ptin
