// SPDX-License-Identifier: GPL-3.0-or-later
//
// The collapses of one tile: from its samples or its children to its records and what it pushes up.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/collapse/cost.h"
#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/hierarchy/tile_push.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"
#include "storage/star.h"

namespace ptin {

/// Starts a leaf: gives all samples of a window and the full surface under it, the same at each
/// call. A leaf is started for its collapses, and once more for tightening.
using LeafStarter = std::function<StartedTile(const SampleRange&)>;

/// What collapsing a tile depends on besides the terrain.
struct CollapseOptions {
  CostModel cost = CostModel::kError;
  MeasureUnits units;
  /// Up to this residual, in height codes, the first pass takes samples of a raster off without a
  /// queue (construct/collapse/first_pass.h). 0: no first pass.
  double first_pass = 0.0;
};

/// A leaf after its collapses.
struct CollapsedLeaf {
  StarredRecords records;  ///< Final. Those of a first pass have empty rings.
  Tile pushed;             ///< With all samples.
  std::unique_ptr<FullSurface> full;
  GridBox box;                     ///< Holds all samples and the full surface.
  std::uint64_t lone_samples = 0;  ///< As StartedTile.
};

/// A tile of level 1 after its collapses.
struct CollapsedGroup {
  StarredRecords records;  ///< Final.
  Tile pushed;             ///< With carried samples.
};

/// A tile of level 2 or more after its collapses.
struct CollapsedInner {
  InnerSegment segment;  ///< To be tightened.
  Tile pushed;           ///< With carried samples.
};

/// Starts a leaf and collapses it until a quarter of its unlocked vertices is left; where it is the
/// root, until no collapse is allowed.
/// @throws Error as the starter and simplify()
[[nodiscard]] CollapsedLeaf collapse_leaf(const TileId& id, const TileTree& tree,
                                          const LeafStarter& start, const CollapseOptions& options,
                                          const std::stop_token& stop);

/// The same for a tile of level 1: joins its leaves and collapses them further. It measures all
/// samples of its leaves too.
/// @param leaves  In the order of TileTree::children(). What they pushed and their surfaces are
///     used up.
/// @throws Error as simplify()
[[nodiscard]] CollapsedGroup collapse_group(const TileId& id, const TileTree& tree,
                                            std::vector<CollapsedLeaf>&& leaves,
                                            const CollapseOptions& options,
                                            const std::stop_token& stop);

/// The same for a tile of level 2 or more, which measures carried samples alone.
/// @param parts  What its children pushed, in the order of TileTree::children(). Used up; their
///     records are foreign to the segment.
/// @throws Error as simplify()
[[nodiscard]] CollapsedInner collapse_inner(const TileId& id, const TileTree& tree,
                                            std::vector<Tile>&& parts,
                                            const CollapseOptions& options,
                                            const std::stop_token& stop);

}  // namespace ptin
