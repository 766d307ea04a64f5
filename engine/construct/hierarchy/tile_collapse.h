// SPDX-License-Identifier: GPL-3.0-or-later
//
// The collapses of one tile: from its samples or its children to its records and what it pushes up.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/hierarchy/tile_push.h"
#include "engine/construct/tile/cost.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Starts a leaf: all samples of a window and the full surface under it, the same whenever it is
/// called. Each leaf is started twice: for its collapses and for tightening.
using LeafStarter = std::function<StartedTile(const SampleRange&)>;

/// What collapsing a tile depends on besides the terrain.
struct CollapseOptions {
  CostModel cost = CostModel::kError;
  MeasureUnits units;
  /// Residual, in codes, up to which samples of a raster go without a queue (first_pass.h); 0:
  /// none.
  double first_pass = 0.0;
};

/// A leaf after its collapses.
struct CollapsedLeaf {
  std::vector<VertexSplit> records;  ///< Final.
  Tile pushed;                       ///< With all samples.
  std::unique_ptr<FullSurface> full;
  GridBox box;  ///< Of all samples and the full surface.
  std::uint64_t lone_samples = 0;
};

/// A tile of level 1 after its collapses.
struct CollapsedGroup {
  std::vector<VertexSplit> records;  ///< Final.
  Tile pushed;                       ///< With witnesses.
};

/// A tile of level 2 or more after its collapses.
struct CollapsedInner {
  InnerSegment segment;  ///< To be tightened.
  Tile pushed;
};

/// Collapses until a quarter of the vertices that are not on seams is left; at the root all that
/// can go.  @throws Error as the starter and simplify()
[[nodiscard]] CollapsedLeaf collapse_leaf(const TileId& id, const TileTree& tree,
                                          const LeafStarter& start, const CollapseOptions& options,
                                          const std::stop_token& stop);

/// The same for a tile of level 1, which measures all samples of its leaves too. The leaves' pushed
/// tiles and surfaces are used up.
/// @param leaves  In the order of TileTree::children().
[[nodiscard]] CollapsedGroup collapse_group(const TileId& id, const TileTree& tree,
                                            std::vector<CollapsedLeaf>&& leaves,
                                            const CollapseOptions& options,
                                            const std::stop_token& stop);

/// The same for a tile whose children pushed `parts`, in the order of TileTree::children(). Their
/// records are foreign to the segment.
[[nodiscard]] CollapsedInner collapse_inner(const TileId& id, const TileTree& tree,
                                            std::vector<Tile>&& parts,
                                            const CollapseOptions& options,
                                            const std::stop_token& stop);

}  // namespace ptin
