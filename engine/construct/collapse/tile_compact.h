// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drops what is removed from a tile's arrays, so that what is left lies together.
#pragma once

#include <cstddef>
#include <limits>

#include "engine/construct/tile/tile.h"
#include "engine/mesh/compact.h"

namespace ptin {

/// As a limit of the samples of a triangle: none.
inline constexpr std::size_t kAllSamples = std::numeric_limits<std::size_t>::max();

/// Drops removed vertices and triangles, and what lies unused between lists of samples: with
/// kAllSamples these are laid out anew. Vertices and triangles keep their order, so that whatever
/// is decided by it stays the same; records are not touched.
/// @param most_samples  Longer lists are cut down to their best witnesses (witness.h).
/// @return  Of each former vertex its new index.
/// Cost: linear; the order of the lists besides, when some may be cut.
Renumbering compact(Tile& tile, std::size_t most_samples);

/// Lays the lists of samples out in the order of their triangles, so that what is near is near in
/// memory. The old ones are there meanwhile. Cost: linear.
void lay_out_samples(Tile& tile);

}  // namespace ptin
