// SPDX-License-Identifier: GPL-3.0-or-later
//
// How pixels lie on the map, and rectangles of them.
#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/affine.h"

namespace ptin {

/// Pixels whose centres stand at origin + (column, row) * step. All parts of a raster that are asked
/// with one lattice have the same centres, bit for bit.
struct PixelLattice {
  MapPoint origin;  ///< The centre of the pixel in column 0 and row 0, map units.
  /// From one centre to the next, map units; negative where columns run to the west, or rows to the
  /// south as in most files. Not 0.
  double step_x = 1.0;
  double step_y = -1.0;
  /// How far outside of the box of the samples, map units, a centre may stand and still be asked
  /// about: on the side of the box. 0: it lies outside. Half a step makes pixels whose areas meet
  /// the box have heights.
  MapPoint margin{};

  [[nodiscard]] MapPoint centre(std::int64_t column, std::int64_t row) const noexcept {
    return {origin.x + step_x * static_cast<double>(column),
            origin.y + step_y * static_cast<double>(row)};
  }
};

/// Columns and rows of a raster.
struct PixelRect {
  std::int64_t column = 0, row = 0, width = 0, height = 0;
  [[nodiscard]] constexpr std::int64_t pixels() const noexcept { return width * height; }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// Two halves across the longer side, for work_in_parts(). REQUIRES: more than one pixel.
[[nodiscard]] constexpr std::array<PixelRect, 2> divided(const PixelRect& r) noexcept {
  PixelRect first = r;
  PixelRect second = r;
  if (r.width >= r.height) {
    first.width = r.width / 2;
    second.column += first.width;
    second.width -= first.width;
  } else {
    first.height = r.height / 2;
    second.row += first.height;
    second.height -= first.height;
  }
  return {first, second};
}

}  // namespace ptin
