// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds a terrain tile by tile: collapses from the leaves to the root, then tightens from the root
// to the leaves (engine/DESIGN.md, sections 5.4 and 5.7).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tasks/stage_progress.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tile_tasks/segment_output.h"
#include "engine/construct/tile_tasks/tile_schedule.h"
#include "engine/mesh/tin.h"

namespace ptin {

struct HierarchyOptions {
  CollapseOptions collapse;
  int threads = 1;
  TaskMemory memory;
  std::function<void(std::uint64_t bytes)> give_back;   ///< TaskLimits::give_back.
  std::chrono::milliseconds checkpoint_interval{2000};  ///< Least time between checkpoints.
  TaskDriver* driver = nullptr;  ///< Who runs the tasks; borrowed; null: threads of this process.
  std::stop_token stop;
  /// Called with the samples and leaves that are done, and all there are. Called by any thread, but
  /// never twice at once. May be empty.
  std::function<void(const StageProgress& progress)> progress;
};

struct BuiltHierarchy {
  Tin t0;                          ///< The coarsest TIN, every vertex and triangle alive.
  std::vector<float> t0_deaths;    ///< One for each of t0.triangles, as deaths_of().
  std::uint64_t lone_samples = 0;  ///< In all leaves; see StartedTile.
  std::uint64_t most_bytes = 0;    ///< The most that was admitted at once, by estimate.
};

/// Builds a whole terrain, or the rest of it when the workspace holds an interrupted build.
/// Segments go to `output` in an order that the tree alone decides. The segments of leaves and of
/// tiles of level 1 are final when the tile is collapsed, since these tiles measure all their
/// samples. The segments of tiles above, a sixteenth of all records, lie in the workspace until
/// tightening.
/// @param make_starter  Called once for each task that runs at once, and once more for tightening.
/// @throws Error as simplify(), the starters and the output; resource_exhausted, io_error. After
///     resource_exhausted, io_error and cancelled a later call can take the workspace up again.
[[nodiscard]] BuiltHierarchy build_hierarchy(const std::function<LeafStarter()>& make_starter,
                                             const TileTree& tree, const HierarchyOptions& options,
                                             Workspace& workspace, SegmentOutput& output);

}  // namespace ptin
