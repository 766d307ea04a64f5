// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slivers that snapping to the grid flattens or turns over, taken away by flipping edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tin_faults.h"

namespace ptin {

/// Mends triangles that were counter-clockwise before their corners were snapped and are no more.
/// One with two corners on one place, or with its longest edge on the border, goes; of another the
/// longest edge is flipped, and so on where that leaves a bad one. Others are left alone.
/// @param slivers  Indices of such triangles.
/// @return  How many triangles were bad on the way. What could not be mended is still there.
/// Cost: O(n log n) when there is one, else nothing.
std::uint64_t flip_slivers(std::span<const GridPoint> positions, std::vector<Corners>& triangles,
                           std::vector<std::uint32_t> slivers);

}  // namespace ptin
