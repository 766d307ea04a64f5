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

/// A mesh on disk: counter-clockwise but for what is wrong with it.
struct MeshOnDisk {
  RecordFile<GridTriangle> triangles;  ///< In the order of ByPlace.
  RecordFile<std::uint64_t> places;    ///< Of their vertices, ascending.
};

/// Flips slivers away (sliver_flips.h), with what surrounds them in memory, as much as that takes;
/// counts those that could not be mended.
/// @return  How many triangles were bad on the way.
/// @throws Error resource_exhausted  what surrounds them is more than 2^20 triangles, or takes
///                                   more than memory.bytes at 256 bytes each
///               io_error, cancelled
/// Cost: nothing without slivers; else some passes over the triangles.
std::uint64_t mend_slivers(MeshOnDisk& mesh, const std::vector<GridTriangle>& slivers,
                           const PointOrder& order, const ExternalMemory& memory, TinFaults& faults,
                           const std::string& path, const std::stop_token& stop);

}  // namespace ptin
