// SPDX-License-Identifier: GPL-3.0-or-later
//
// The place of a spot in one triangle, told from the triangle alone.
#pragma once

#include <array>

#include "engine/query/living/living_triangle.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Twice the areas of the triangles of q and the side opposite to each corner.
[[nodiscard]] std::array<Int128, 3> weights_of(const LivingTriangle& t, Spot q);

/// The code of the height of a surface triangle at a spot that it holds, the same from both sides
/// of an edge, as the mean of the codes of its corners (walk/walk.h).
[[nodiscard]] WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights,
                                     Spot q);
/// The same where weights_of(t, q) are known.
[[nodiscard]] WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights, Spot q,
                                     const std::array<Int128, 3>& weights);

}  // namespace ptin
