// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/hierarchy.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/check.h"
#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/hierarchy/collapse_stage.h"
#include "engine/construct/hierarchy/tighten_stage.h"
#include "engine/construct/hierarchy/tile_files.h"

namespace ptin {

namespace {

/// Gives the records that the root pushed up the final bounds that tightening left in a file.
void take_final_bounds(const BuildLog& log, const TileId& root, Tile& pushed) {
  ArrayFileReader file(log.path(root, kBoundsEnding), log.tightened().at(root));
  const std::vector<RecordBounds> bounds = file.take_copy<RecordBounds>();
  PTIN_CHECK(bounds.size() == pushed.records.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    pushed.records[i].error = bounds[i].error;
    pushed.records[i].deviation = bounds[i].deviation;
  }
}

}  // namespace

BuiltHierarchy build_hierarchy(const std::function<LeafStarter()>& make_starter,
                               const TileTree& tree, const HierarchyOptions& options,
                               Workspace& workspace, SegmentOutput& output) {
  const PieceLimits limits{options.threads, options.memory_for_tiles, options.give_back};
  const BatchOrder order(tree);
  BuildLog log(workspace, output, options.checkpoint_interval);
  BuiltHierarchy result;
  {
    CollapseStage stage(make_starter, tree, order, options, log);
    result.most_bytes = run_pieces(stage, limits, options.stop);
    stage.finish();
  }
  for (const auto& [id, tile] : log.collapsed()) {
    result.lone_samples += tile.lone_samples;
  }
  const TileId root = tree.root();
  ArrayFileReader file(log.path(root, kPushedEnding), log.collapsed().at(root).pushed);
  Tile pushed = read_pushed(file, options.collapse.units);
  if (root.level > 1) {  // else all tiles measured all their samples, and are final
    TightenStage stage(make_starter, tree, order, pushed.tin, options, log);
    result.most_bytes = std::max(result.most_bytes, run_pieces(stage, limits, options.stop));
    stage.finish();
    take_final_bounds(log, root, pushed);
  }
  result.t0_deaths = deaths_of(pushed);
  result.t0 = std::move(pushed.tin);
  return result;
}

}  // namespace ptin
