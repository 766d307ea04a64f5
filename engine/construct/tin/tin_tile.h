// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from a TIN's own triangles.
#pragma once

#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tin/tin_source.h"

namespace ptin {

/// Starts the leaf that has this window: its part of the triangles, and of the full surface.
/// @throws Error as TinTriangles::part()
/// Threads: any number at once.
[[nodiscard]] StartedTile start_tin_tile(const TinTriangles& triangles, const TileTree& tree,
                                         const SampleRange& window, const MeasureUnits& units);

}  // namespace ptin
