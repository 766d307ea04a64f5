// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drops what is removed from a tile's arrays, so that what is left lies close together.
#pragma once

#include <cstddef>
#include <limits>

#include "engine/construct/tile/tile.h"
#include "engine/mesh/compact.h"

namespace ptin {

/// As the limit of samples of a triangle: no limit.
inline constexpr std::size_t kAllSamples = std::numeric_limits<std::size_t>::max();

/// Drops removed vertices and triangles, and the gaps between lists of samples. Vertices and
/// triangles keep their order, so that whatever is decided by it stays the same. Records are not
/// touched.
/// @param most_samples  Longer lists are cut down to their weightiest samples
///     (construct/collapse/carried_samples.h), and all lists move up in place. With kAllSamples no
///     list is cut, and lay_out_samples() is called instead.
/// @return  The new index of each former vertex; kNone for a removed one.
/// Cost: linear; unless most_samples is kAllSamples, n log n in the number of lists besides.
Renumbering compact(Tile& tile, std::size_t most_samples);

/// Lays the lists of samples out in the order of their triangles, so that what is near is near in
/// memory. The old lists take memory until the new ones are complete. Cost: linear.
void lay_out_samples(Tile& tile);

}  // namespace ptin
