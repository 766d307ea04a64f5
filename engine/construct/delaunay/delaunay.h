// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of points: their Delaunay triangulation.
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
/// Law: the triangulation depends on the set of points alone, so tiles agree wherever a triangle's
/// closed circumdisc lies in what each has seen. Where four or more points lie on one circle the
/// tie is broken by the symbolic perturbation of Devillers and Teillaud (CGAL's): of points on a
/// circle the last one in the order by x, then y, counts as outside of the circle of the others. So
/// it is cut off as an ear, then the last of the remaining ones, and so on: a square cell is cut
/// along its falling diagonal.
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
