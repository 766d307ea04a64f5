// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pockets and holes of any number of border edges, triangulated by a line that sweeps over them.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "engine/construct/tin/tin_border.h"

namespace ptin {

/// Fills the convex hull around and between surface triangles with void triangles, as fill_hull()
/// does, but keeps only those border edges in memory that one horizontal line crosses. The
/// triangles are worse than those of fill_hull(): they are made as the line meets vertices, and not
/// Delaunay.
///
/// The line goes up over the vertices. The *gap* between two edges next to each other on the line
/// is surface or void. Below a gap of void lies a *chain* of vertices, from the lower end of the
/// edge on its left to the lower end of the edge on its right, which bulges into the void at every
/// vertex between these. A new vertex makes triangles with those edges of the chain that it sees,
/// and joins the chain (Hertel and Mehlhorn: Fast triangulation of simple polygons, 1983).
/// @param border  Edges with counter-clockwise triangles on their left, in any order.
/// @param memory  A quarter of its bytes is for sorting, a half for the line and its chains.
/// @param visit   Receives the void triangles, counter-clockwise, in no order that means anything.
/// @param faults  Receives the first T-junction, crossing or doubly covered place that is met; the
///                work then ends, and the triangles so far mean nothing.
/// @param path    Path of the TIN, for errors.
/// @throws Error cancelled, io_error; resource_exhausted  the line crosses more edges than fit, or
///               the disk is full; and what `visit` throws
/// Cost: O(b log b) for b edges.
void sweep_voids(const RecordFile<GridEdge>& border, const ExternalMemory& memory,
                 const std::function<void(const std::array<GridVertex, 3>&)>& visit,
                 TinFaults& faults, const std::string& path, const std::stop_token& stop = {});

}  // namespace ptin
