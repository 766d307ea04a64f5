// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drops what is removed from a tile's arrays, so that what is left lies together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/tile.h"

namespace ptin {

/// Old index to new one, for those kept; kNone for the others.
using Renumbering = std::vector<std::uint32_t>;

/// Drops removed vertices and triangles, and lays the lists of samples out in the order of their
/// triangles. Vertices and triangles keep their order, so that whatever is decided by it stays the
/// same; records are not touched.
/// @param most_samples  Longer lists are cut down to their best witnesses (witness.h).
/// @return  Of each former vertex its new index.
/// Cost: linear.
Renumbering compact(Tile& tile, std::size_t most_samples);

/// The last part of it: lists of samples only.
void lay_out_samples(Tile& tile, std::size_t most_samples);

}  // namespace ptin
