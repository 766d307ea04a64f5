// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines from their files onto the grid of the points.
#pragma once

#include <stop_token>

#include "engine/construct/grid/point_grid.h"
#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/lines/source_lines.h"

namespace ptin {

/// What lines become on a grid.
struct LinesOnGrid {
  FixedEdges edges;
  /// By which rounding to the grid moved a vertex, or a crossing, at most; CRS units.
  double largest_shift_plan = 0.0;
};

/// Rounds the vertices of all lines to the grid, and nodes the lines (lines/line_noding.h).
/// @param grid  That PointGridScan found with these lines among what it saw.
/// @throws Error  as node_lines(); invalid_argument where the boundary encloses nothing
[[nodiscard]] LinesOnGrid put_on_grid(const SourceLines& lines, const PointGrid& grid,
                                      const std::stop_token& stop = {});

}  // namespace ptin
