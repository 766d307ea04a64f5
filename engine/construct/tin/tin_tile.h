// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a TIN's own triangles.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tin/tin_source.h"

namespace ptin {

/// Starts the leaf that has this window: its part of the triangles, and of the full surface.
/// @throws Error as TinTriangles::part()
/// Threads: any number at once.
[[nodiscard]] StartedTile start_tin_tile(const TinTriangles& triangles, const TileTree& tree,
                                         const SampleRange& window, const MeasureUnits& units);

/// The tree over the vertices of a TIN. @param side  As TileTree; none means
/// TileTree::default_side() of a square of as many samples.
[[nodiscard]] TileTree tin_tree(const TinTriangles& triangles, std::optional<std::int64_t> side);

}  // namespace ptin
