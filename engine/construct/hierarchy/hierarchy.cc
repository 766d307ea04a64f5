// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/hierarchy.h"

#include <algorithm>

#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/hierarchy/collapse_stage.h"
#include "engine/construct/hierarchy/tighten_stage.h"
#include "engine/construct/hierarchy/tile_files.h"

namespace ptin {

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
  result.t0 = read_pushed(file, options.collapse.units).tin;
  if (root.level > 1) {  // else all tiles measured all their samples, and are final
    TightenStage stage(make_starter, tree, order, result.t0, options, log);
    result.most_bytes = std::max(result.most_bytes, run_pieces(stage, limits, options.stop));
    stage.finish();
  }
  return result;
}

}  // namespace ptin
