// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pockets and holes of any number of border edges, triangulated by a line that sweeps over them.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "engine/construct/tin/tin_border.h"

namespace ptin {

/// Fills the convex hull around and between surface triangles with void ones, as fill_hull() does,
/// but in the memory that the edges take which a horizontal line crosses. The triangles are worse:
/// as they come, not Delaunay.
///
/// A line goes up over the vertices. Between two edges next to each other on it lies surface or
/// void. Below a piece of void is a chain of vertices, bent into the void everywhere, from the
/// last vertex of the edge on its left to that of the edge on its right; a new vertex takes all
/// edges of the chain that it sees, from the chain's highest vertex on, for triangles (Hertel and
/// Mehlhorn: Fast triangulation of simple polygons, 1983).
/// @param border  Of counter-clockwise triangles.
/// @param visit   Receives counter-clockwise triangles.
/// @param faults  Receives the first T-junction, crossing or piece that is covered twice: then the
///                work ends.
/// @param path    Of the TIN, for errors.
/// @throws Error cancelled, io_error; resource_exhausted  the line crosses more edges than fit
/// Cost: O(b log b).
void sweep_voids(const RecordFile<GridEdge>& border, const ExternalMemory& memory,
                 const std::function<void(const std::array<GridVertex, 3>&)>& visit,
                 TinFaults& faults, const std::string& path, const std::stop_token& stop = {});

}  // namespace ptin
