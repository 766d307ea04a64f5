// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slivers that snapping to the grid flattens or turns over, taken away by flipping edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tin/tin_faults.h"

namespace ptin {

/// What became of slivers.
struct SliverFlips {
  std::uint64_t mended = 0;  ///< Triangles that were bad on the way.
  /// Ends of an edge beyond which the mesh goes on, but not in the triangles at hand: they are to
  /// be thrown away, and the work done again with all triangles around these.
  std::vector<VertexId> beyond;
};

/// Mends triangles that were counter-clockwise before their corners were snapped and are no more.
/// One with two corners on one place, or with its longest edge on the border, goes; of another the
/// longest edge is flipped, and so on where that leaves a bad one. What cannot be mended so is
/// still there.
/// @param triangles    A part of a mesh.
/// @param slivers      Indices of such triangles.
/// @param is_complete  Beside positions: 1 where all triangles of the mesh at a vertex are at hand.
/// Cost: O(n log n) when there is one, else nothing.
[[nodiscard]] SliverFlips flip_slivers(std::span<const GridPoint> positions,
                                       std::vector<Corners>& triangles,
                                       std::vector<std::uint32_t> slivers,
                                       std::span<const std::uint8_t> is_complete);

}  // namespace ptin
