// SPDX-License-Identifier: GPL-3.0-or-later
//
// The deviation of a fan along its edges.
#pragma once

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// Largest gap to the full surface, in codes, along the edges of a fan that are new to a surface
/// triangle: inner edges with surface on one side at least; and of the link the two edges at w
/// where the triangle that vanishes is void and the fan's is surface. Other link edges are covered
/// by what the star carries.
/// @param within  Edges that do not meet this box are left out: the window of `full`.
/// Cost: the crossings.
[[nodiscard]] double fan_deviation(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                                   const FullSurface& full, const GridBox& within);

/// Every edge meets this one.
inline constexpr GridBox kEverywhere{0, 0, kGridMax, kGridMax};

}  // namespace ptin
