// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Delaunay triangulation of points in memory, all at once: what tiles (tile_delaunay.h) are held
// against, and what small terrains of tests and benchmarks are made of.
#pragma once

#include <span>
#include <stop_token>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The Delaunay triangulation of points on the grid, with exact predicates. Its domain is the
/// convex hull; points on the hull's edges are border vertices. Every triangle is a surface
/// triangle.
///
/// Ties are broken as DelaunayTiler breaks them (engine/construct/delaunay/tile_delaunay.h).
///
/// @param positions  In strictly ascending order of key_of(): sorted, all distinct, on the grid.
/// @param heights    Beside `positions`.
/// @return  Vertex ids are indices into `positions`; triangles start with their smallest id, and
///          are in ascending order of (first, second) corner.
/// @throws Error  invalid_argument    fewer than 3 points, all collinear, not in order, or not on
///                                    the grid
///                resource_exhausted  more points than one mesh in memory counts
///                cancelled           `stop` fired
/// Cost: O(n log n) expected, about 1.4 us and 250 bytes a point while it runs.
/// Threads: any number of calls at once.
[[nodiscard]] Tin make_delaunay_tin(std::span<const GridPoint> positions,
                                    std::span<const HeightBits> heights,
                                    const std::stop_token& stop = {});

}  // namespace ptin
