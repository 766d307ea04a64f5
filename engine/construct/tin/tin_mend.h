// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slivers that snapping spoiled, mended in a mesh on disk.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/tin/tin_on_grid.h"

namespace ptin {

class PointOrder;

/// A mesh on disk. Its triangles are counter-clockwise but for slivers and faults.
struct MeshOnDisk {
  RecordFile<GridTriangle> triangles;  ///< Ascending.
  RecordFile<std::uint64_t> places;    ///< Places of their vertices along the curve, ascending.
};

/// Flips slivers away. The triangles around them are taken into memory as a
/// patch, which grows until no flip leaves it, and which then replaces its former triangles on
/// disk. Vertices that lose all their triangles go.
/// @param slivers  Triangles of `mesh` that snapping spoiled.
/// @param faults   Its no_area and turned_over count those that could not be mended.
/// @param path     Path of the TIN, for errors.
/// @return  How many bad triangles were taken away: slivers, and what flips made.
/// @throws Error resource_exhausted  the patch has more than 2^20 triangles, or takes more than
///                                   memory.bytes at 256 bytes a triangle
///               io_error, cancelled
/// Cost: nothing without slivers; else a pass over all triangles for each size of the patch, and
/// one to write them.
std::uint64_t mend_slivers(MeshOnDisk& mesh, const std::vector<GridTriangle>& slivers,
                           const PointOrder& order, const ExternalMemory& memory, TinFaults& faults,
                           const std::string& path, const std::stop_token& stop);

}  // namespace ptin
