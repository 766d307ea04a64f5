// SPDX-License-Identifier: GPL-3.0-or-later
//
// Witnesses: the few samples of a triangle that a parent tile takes along (engine/DESIGN.md, section 5.6).
#pragma once

#include <cstddef>
#include <vector>

#include "engine/construct/tile/sample_lists.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

inline constexpr std::size_t kWitnessesOfTriangle = 16;
/// Samples that a triangle of a tile of witnesses may keep while it is collapsed, at least and at
/// most: coarse fans would otherwise hold all of them.
inline constexpr std::size_t kWitnessesInWork = 32;
inline constexpr std::size_t kMostWitnessesInWork = 1024;

/// Cuts the samples of a triangle down to at most `most`: those with the largest residuals of
/// either sign, spread over its corners; of samples in the wrong class the deepest, and of voids in
/// a void triangle the deepest too, so that a parent knows what a surface over them would cost.
/// They order the collapses of the parent and bound nothing: tightening does (tighten.h).
/// Deterministic; a block is taken for its first sample. Cost: n log n.
/// REQUIRES: most >= 6.
void choose_witnesses(const Tile& tile, TriangleId t, std::vector<Sample>& samples,
                      std::size_t most = kWitnessesOfTriangle);

}  // namespace ptin
