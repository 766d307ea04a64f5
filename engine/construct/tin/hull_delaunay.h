// SPDX-License-Identifier: GPL-3.0-or-later
//
// From triangles with any border to a convex domain: pockets and holes triangulated.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/tin/tin_faults.h"

namespace ptin {

/// Counts vertices inside of border edges, and border edges that cross.
/// Cost: O(b log^2 b + pairs of edges whose boxes meet).
void check_border(std::span<const GridPoint> positions, std::span<const BorderEdge> border,
                  TinFaults& faults);

/// The triangles that fill the convex hull around and between surface triangles: a constrained
/// Delaunay triangulation of the border's vertices with the border's edges kept. Counter-clockwise.
/// Also counts pieces that the surface covers more than once (another surface on top of it), by
/// the winding number of the border.
/// REQUIRES: a border that passed check_border(): edges meet in vertices alone.
/// @throws Error cancelled
/// Cost: O(b log b) expected for b vertices of the border.
[[nodiscard]] std::vector<Corners> fill_hull(std::span<const GridPoint> positions,
                                             std::span<const BorderEdge> border, TinFaults& faults,
                                             const std::stop_token& stop = {});

}  // namespace ptin
