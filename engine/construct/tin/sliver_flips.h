// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slivers that snapping to the grid flattens or turns over, taken away by flipping edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tin/tin_faults.h"

namespace ptin {

/// Counts of slivers by what became of them.
struct SliverFlips {
  std::uint64_t mended = 0;  ///< Bad triangles that were taken away: slivers, and what flips made.
  /// Ends of edges beyond which there may be a triangle of the mesh that is not at hand. Where
  /// there are any, the triangles at hand are to be thrown away, and the work is to be done again
  /// with all triangles around these vertices.
  std::vector<VertexId> beyond;
};

/// Mends slivers: triangles that were counter-clockwise before their corners were snapped to the
/// grid, and are not any more. A sliver with two corners on one place is removed, and so is a
/// sliver whose longest edge lies on the border. The longest edge of any other sliver is flipped; a
/// triangle that the flip makes and that is bad too is mended in the same way. After 64 steps for
/// each sliver that was given the rest of them stay in `triangles`.
/// @param positions    Positions of the vertices, by id.
/// @param triangles    A part of a mesh. Removing triangles changes the indices of others.
/// @param slivers      Indices into `triangles`.
/// @param is_complete  By `positions`: 1 where all triangles of the mesh at a vertex are given.
/// Cost: O(n) expected for n triangles when there is a sliver, else nothing.
[[nodiscard]] SliverFlips flip_slivers(std::span<const GridPoint> positions,
                                       std::vector<Corners>& triangles,
                                       std::vector<std::uint32_t> slivers,
                                       std::span<const std::uint8_t> is_complete);

}  // namespace ptin
