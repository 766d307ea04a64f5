// SPDX-License-Identifier: GPL-3.0-or-later
//
// Carried samples: the few of a triangle that a parent tile takes along (engine/DESIGN.md, section
// 5.6).
#pragma once

#include <cstddef>
#include <vector>

#include "engine/construct/tile/sample_lists.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// Carried samples of a triangle that is pushed up.
inline constexpr std::size_t kCarriedSamples = 16;
/// The least and the greatest limit of samples of a triangle while a tile of carried samples is
/// collapsed. Without a limit the few coarse fans at the end would hold those of all.
inline constexpr std::size_t kCarriedInWork = 32;
inline constexpr std::size_t kMostCarriedInWork = 1024;

/// Cuts the samples of a triangle down to at most `most`, the weightiest ones, spread over its
/// corners and over both signs. The weight of a sample with a height in a surface triangle is its
/// |residual|. The weight of any other sample is what its reach would be charged: so of samples in
/// the wrong class those that reach farthest stay, and in a void triangle such voids too, which
/// show a parent what a surface over them would cost. A block counts as its first sample. Carried
/// samples order the collapses of the parent and bound nothing: tightening does
/// (construct/hierarchy/tighten.h). Deterministic. Cost: n log n. REQUIRES: most >= 6.
void choose_carried_samples(const Tile& tile, TriangleId t, std::vector<Sample>& samples,
                            std::size_t most = kCarriedSamples);

}  // namespace ptin
