// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds a terrain tile by tile: collapses from the leaves to the root, then tightens from the root
// to the leaves (engine/DESIGN.md, sections 5.4 and 5.7).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "engine/construct/hierarchy/segment_output.h"
#include "engine/construct/hierarchy/stage_progress.h"
#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/mesh/tin.h"

namespace ptin {

struct HierarchyOptions {
  CollapseOptions collapse;
  int threads = 1;
  std::uint64_t memory_for_tiles = ~std::uint64_t{0};  ///< Bytes of all tiles in work at once.
  TileBytes tile_bytes;                                ///< What each kind of work takes of them.
  std::function<void(std::uint64_t bytes)> give_back;  ///< As PieceLimits says.
  std::chrono::milliseconds checkpoint_interval{2000};
  std::stop_token stop;
  /// Samples and leaves done and in all; called by any thread, but never twice at once. May be empty.
  std::function<void(const StageProgress& progress)> progress;
};

struct BuiltHierarchy {
  Tin t0;  ///< The coarsest TIN, every vertex alive.
  std::uint64_t lone_samples = 0;
  std::uint64_t most_bytes = 0;  ///< Admitted at once, by estimate.
};

/// Builds everything, or the rest of it when the workspace holds an interrupted build. Segments go
/// to `output` in the order of the tree. Those of leaves and of level 1 are final when the tile is
/// collapsed, since they measure all their samples; those of tiles above, a sixteenth of all
/// records, lie in the workspace until tightening.
/// @param make_starter  Called once for each thread.
/// @throws Error as simplify(), the starters and the output; resource_exhausted, io_error; after
/// the last two, and cancelled, the workspace can be taken up again.
[[nodiscard]] BuiltHierarchy build_hierarchy(const std::function<LeafStarter()>& make_starter,
                                             const TileTree& tree, const HierarchyOptions& options,
                                             Workspace& workspace, SegmentOutput& output);

}  // namespace ptin
