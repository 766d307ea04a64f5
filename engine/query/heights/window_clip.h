// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of a triangle that lies in a window.
#pragma once

#include <array>
#include <vector>

#include "engine/query/select/region.h"

namespace ptin {

/// x, y in grid units, and a value.
using ClippedCorner = std::array<double, 3>;

/// The part of a convex polygon in a window: of a triangle at most seven corners, in the order of the
/// polygon. Values at cuts are interpolated along the side that is cut, the same from both of its
/// ends. Cost: the corners.
[[nodiscard]] std::vector<ClippedCorner> clipped(std::vector<ClippedCorner> polygon,
                                                 const GridWindow& window);

}  // namespace ptin
