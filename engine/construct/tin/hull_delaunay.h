// SPDX-License-Identifier: GPL-3.0-or-later
//
// From triangles with any border to a convex domain: pockets and holes triangulated.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/tin/tin_faults.h"

namespace ptin {

/// Counts the faults of a border against itself: vertices inside of border edges (T-junctions), and
/// pairs of border edges that cross.
/// @param positions  Positions of the vertices, by id.
/// @param faults     Its t_junctions and crossings grow.
/// Cost: O(b log^2 b + pairs of edges whose boxes meet) for b edges.
void check_border(std::span<const GridPoint> positions, std::span<const BorderEdge> border,
                  TinFaults& faults);

/// The triangles that fill the convex hull around and between surface triangles: those faces of a
/// constrained Delaunay triangulation of the border's vertices, with the border's edges kept, that
/// the surface does not cover. The winding number of the border says how often it covers a face.
/// @param positions  Positions of the vertices, by id.
/// @param border     In ascending order of (from, to).
/// @param faults     Its `covered` counts the faces that are covered more than once.
/// @return  Ids of the corners, counter-clockwise from the smallest; in ascending order.
/// REQUIRES: a border in which check_border() finds no fault: edges meet in vertices alone.
/// @throws Error cancelled
/// Cost: O(b log b) expected for b vertices of the border.
[[nodiscard]] std::vector<Corners> fill_hull(std::span<const GridPoint> positions,
                                             std::span<const BorderEdge> border, TinFaults& faults,
                                             const std::stop_token& stop = {});

}  // namespace ptin
