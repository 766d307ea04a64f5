// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells in which a terrain of any size is walked: squares of the grid, along the Hilbert curve.
#pragma once

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

/// What walk_fitting_cells() asks of a cell of more than one position: whether to visit it whole.
/// @param share  The part of the first cell's area that it has: a quarter for each time it was
///               halved.
using CellFits = std::function<bool(const GridCell& cell, double share)>;
/// @param done  The share of the domain's area that is done after this cell.
using VisitCell = std::function<void(const GridCell& cell, double done)>;

/// Begins with the smallest cell that holds `domain`, cuts a cell that does not fit into four, and
/// visits those that do and meet the domain, in the order of the Hilbert curve
/// (hilbert_position()). A cell of a single position is visited without being asked. Every position
/// of the domain lies in exactly one cell.
/// @throws what `fits` and `visit` throw
void walk_fitting_cells(const GridBox& domain, const CellFits& fits, const VisitCell& visit);

}  // namespace ptin
