// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a raster: every cell cut along one diagonal.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/geometry/point.h"

namespace ptin {

/// The diagonal that cuts a cell: from its lower left to its upper right corner, or from its lower
/// right to its upper left one.
enum class Diagonal : std::uint8_t { kRising = 0, kFalling = 1 };

/// A cell's four corners, counter-clockwise from the lower left.
struct RasterCell {
  double code[4];  ///< Height codes; not looked at where `has_height` is 0.
  std::uint8_t has_height[4];
};

/// The corner with a number of RasterCell's, of the cell whose lower left one is `corner`.
[[nodiscard]] constexpr GridPoint cell_corner(GridPoint corner, std::size_t number) noexcept {
  return {corner.x + (number == 1 || number == 2 ? 1 : 0), corner.y + (number >= 2 ? 1 : 0)};
}

/// The diagonal that cuts the cell whose lower left corner is the grid point `corner`. It depends
/// on the cell alone, so tiles agree. In this order:
///   1. the diagonal with fewer ends without a height (so that one void corner costs one triangle,
///      not two);
///   2. with four heights, the diagonal with the smaller difference between the codes at its ends;
///   3. rising where x + y of `corner` is even, falling where it is odd.
[[nodiscard]] inline Diagonal cell_diagonal(const RasterCell& cell, GridPoint corner) noexcept {
  const int rising_void = !cell.has_height[0] + !cell.has_height[2];
  const int falling_void = !cell.has_height[1] + !cell.has_height[3];
  if (rising_void != falling_void) {
    return rising_void < falling_void ? Diagonal::kRising : Diagonal::kFalling;
  }
  if (rising_void == 0) {
    const double rising = std::abs(cell.code[0] - cell.code[2]);
    const double falling = std::abs(cell.code[1] - cell.code[3]);
    if (rising != falling) {
      return rising < falling ? Diagonal::kRising : Diagonal::kFalling;
    }
  }
  // The sum of both coordinates itself may not fit.
  return ((corner.x ^ corner.y) & 1) == 0 ? Diagonal::kRising : Diagonal::kFalling;
}

/// The corners of a cell's two triangles, counter-clockwise, as numbers of RasterCell's; the triangle at
/// its lower edge first. A triangle is void when one of its corners has no height.
using CellTriangles = std::array<std::array<std::uint8_t, 3>, 2>;
[[nodiscard]] constexpr CellTriangles cell_triangles(Diagonal diagonal) noexcept {
  return diagonal == Diagonal::kRising ? CellTriangles{{{0, 1, 2}, {0, 2, 3}}}
                                       : CellTriangles{{{0, 1, 3}, {1, 2, 3}}};
}

}  // namespace ptin
