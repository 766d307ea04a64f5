// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/build_hierarchy.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/check.h"
#include "engine/construct/hierarchy/tile_files.h"
#include "engine/construct/tile_tasks/build_log.h"
#include "engine/construct/tile_tasks/tile_schedule.h"
#include "engine/construct/tile_tasks/tile_worker.h"

namespace ptin {

namespace {

/// T0 and its deaths: what the root pushed up, with the final bounds of its records.
void take_coarsest(const BuildLog& log, const TileTree& tree, const MeasureUnits& units,
                   BuiltHierarchy& built) {
  const TileId root = tree.root();
  const auto read = [&](TileFile file, auto&& with) {
    const InputFile input{root, file, log.results().at(producer_of(root, file)).facts(file)};
    return read_input(log.workspace().temporary_folder(), input, with);
  };
  Tile pushed =
      read(TileFile::kPushed, [&](ArrayFileReader& file) { return read_pushed(file, units); });
  if (root.level > 1) {  // else all tiles measured all their samples, and are final
    const auto bounds = read(TileFile::kBounds,
                             [](ArrayFileReader& file) { return file.take_copy<RecordBounds>(); });
    PTIN_CHECK(bounds.size() == pushed.records.size());
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      pushed.records[i].error = bounds[i].error;
      pushed.records[i].deviation = bounds[i].deviation;
    }
  }
  built.t0_deaths = deaths_of(pushed);
  built.t0 = std::move(pushed.tin);
}

}  // namespace

BuiltHierarchy build_hierarchy(const std::function<LeafStarter()>& make_starter,
                               const TileTree& tree, const HierarchyOptions& options,
                               Workspace& workspace, SegmentOutput& output) {
  const BatchOrder order(tree);
  BuildLog log(workspace, output, options.checkpoint_interval);
  TileWorker worker({tree, options.collapse, make_starter, output.packer(), workspace.files(),
                     workspace.temporary_folder()});
  TileSchedule schedule(tree, order, options.memory, log, options.progress);
  TaskDriver threads;
  TaskDriver& driver = options.driver != nullptr ? *options.driver : threads;
  const TaskLimits limits{options.threads, options.memory.for_tiles, options.give_back};
  BuiltHierarchy built;
  for (bool is_read = false; !is_read;) {
    built.most_bytes =
        std::max(built.most_bytes, driver.run(schedule, worker, limits, options.stop));
    PTIN_CHECK(schedule.is_complete());
    log.checkpoint(true);
    try {
      take_coarsest(log, tree, options.collapse.units, built);
      is_read = true;
    } catch (const DamagedInput& damage) {
      schedule.write_again(damage);
    }
  }
  for (const auto& [name, result] : log.results()) {
    built.lone_samples += result.lone_samples;
  }
  return built;
}

}  // namespace ptin
