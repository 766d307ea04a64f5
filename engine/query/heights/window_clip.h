// SPDX-License-Identifier: GPL-3.0-or-later
//
// A window and what lies in it: the part of a triangle, and whether any of the domain does.
#pragma once

#include <array>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/region.h"

namespace ptin {

/// x, y in grid units, and a value.
using ClippedCorner = std::array<double, 3>;

/// The part of a convex polygon in a window: of a triangle at most seven corners, in the order of the
/// polygon. Values at cuts are interpolated along the side that is cut. Cost: the corners.
[[nodiscard]] std::vector<ClippedCorner> clipped(std::vector<ClippedCorner> polygon,
                                                 const GridWindow& window);

/// Whether the window and the domain, which the triangles of T0 cover, share a point. Exact for the
/// corners of the window as spots.
/// @param bounds  Box of the domain.
/// Cost: the triangles of T0.
[[nodiscard]] bool meets_domain(const GridWindow& window, const Tin& t0, const GridBox& bounds);

}  // namespace ptin
