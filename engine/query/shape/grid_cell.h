// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells in which a terrain of any size is walked: squares of the grid, along the Hilbert curve.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A square of 2^level x 2^level grid positions, its corner a multiple of 2^level. Its positions
/// follow one another along the Hilbert curve.
struct GridCell {
  std::uint32_t x = 0, y = 0;  ///< Lower left corner, a multiple of 2^level.
  int level = 0;

  /// Its positions, clipped to the grid.
  [[nodiscard]] GridBox box() const noexcept;
  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    return (static_cast<std::uint32_t>(p.x) >> level) == (x >> level) &&
           (static_cast<std::uint32_t>(p.y) >> level) == (y >> level);
  }
};

/// Where the middle of a box lies along the Hilbert curve; of a box that reaches beyond the grid that of
/// the nearest position.
[[nodiscard]] std::uint64_t position_along(const GridBox& box) noexcept;

/// The quarters of a cell, in the order of the Hilbert curve (hilbert_position()). REQUIRES: more
/// than one position.
[[nodiscard]] std::array<GridCell, 4> divided(const GridCell& cell);

/// Works on one cell. False: it does not fit, and is cut into four.
/// @param share  The part of the first cell's area that it has: a quarter for each time it was cut.
/// @param done   The share of the domain's area that is done after this cell.
using WorkOnCell = std::function<bool(const GridCell& cell, double share, double done)>;

/// Works on a domain cell by cell, beginning with the smallest cell that holds it, in the order of
/// the Hilbert curve. Every position of the domain lies in exactly one cell that is done.
/// REQUIRES: of a single position `work` returns true, or throws.
/// @throws what `work` throws
void work_on_cells(const GridBox& domain, const WorkOnCell& work);

}  // namespace ptin
