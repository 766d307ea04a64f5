// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_worker.h"

#include <algorithm>
#include <optional>

#include "engine/construct/build_job.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/points/point_tasks.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/source_files.h"
#include "engine/construct/source_kind.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/construct/tile_tasks/task_graph.h"
#include "engine/construct/tile_tasks/tile_worker.h"
#include "engine/construct/tiled_source.h"
#include "engine/error.h"

namespace ptin {

using namespace build_internal;

namespace {

/// @throws Error invalid_argument  this process sees other inputs than the one that directs it, or,
///     after it has waited for them, not the folders of the build
void require_same(const BuildNote& note, const std::vector<std::string>& inputs,
                  const BuildOptions& options, const BuildResources& resources) {
  for (const std::string& folder : {note.folder, note.temporary}) {
    if (!folder.empty() && !await_file(folder, resources.patience, resources.stop)) {
      throw Error(ErrorCode::invalid_argument,
                  "this process does not see the folder of the build; it must be one that all "
                  "processes share",
                  folder);
    }
  }
  if (input_fingerprint(all_inputs(inputs, options)) != note.inputs) {
    throw Error(ErrorCode::invalid_argument,
                "an input is not the one that the build began with: its size or time of change "
                "differ; build anew, or give all processes the same files",
                inputs.empty() ? "" : inputs.front());
  }
}

}  // namespace

struct BuildWorker::Impl {
  Impl(const std::vector<std::string>& named, const BuildOptions& options,
       const BuildResources& given, const BuildNote& note)
      : inputs(with_folders_opened(named)),
        resources(given),
        files(given.files != nullptr ? *given.files : FileLayer::system()),
        memory(plan_memory(given.memory_bytes, source_kind(inputs, options))),
        cache(memory.gdal_cache) {
    require_same(note, inputs, options, given);
    if (note.index.is_null()) {
      open_to_read(source_options_of(options), note);
    } else {
      open_tiles(options, note);
    }
  }
  void open_to_read(const SourceOptions& options, const BuildNote& note);
  void open_tiles(const BuildOptions& options, const BuildNote& note);
  [[nodiscard]] BuildPlan plan() const;
  void make_room(std::uint64_t bytes) const;

  const std::vector<std::string> inputs;  ///< Folders opened; what reads them refers to it.
  BuildResources resources;
  FileLayer& files;
  MemoryPlan memory;
  GdalCacheLimit cache;
  std::optional<TiledSource> tiles;  ///< None while the source is being read.
  std::unique_ptr<StorePacker> packer;
  std::unique_ptr<TaskWorker> worker;
};

void BuildWorker::Impl::open_to_read(const SourceOptions& options, const BuildNote& note) {
  if (memory.kind == InputKind::kRaster) {
    worker = RasterSource::open_to_scan(inputs, options);
  } else if (memory.kind == InputKind::kPoints) {
    const auto await = [patience = resources.patience, stop = resources.stop](
                           const std::string& path) { await_file(path, patience, stop); };
    worker = std::make_unique<PointTasks>(inputs, options,
                                          PointFiles{files, note.temporary, await, true});
  } else {
    throw Error(ErrorCode::internal, "this kind of source is read by one process");
  }
}

void BuildWorker::Impl::open_tiles(const BuildOptions& options, const BuildNote& note) {
  tiles = take_up_source(inputs, options, note.index, note.temporary, files, resources.stop);
  packer = std::make_unique<StorePacker>(options, tiles->frame, static_cast<bool>(tiles->add_floor),
                                         files, note.folder);
  worker = std::make_unique<TileWorker>(TaskSetup{tiles->tree, collapse_options(options, *tiles),
                                                  tiles->make_starter, *packer, files,
                                                  note.temporary, true, resources.patience});
  if (resources.observer != nullptr) {
    resources.observer->plan(plan());
  }
}

/// What one task at a time takes here, the last join apart.
BuildPlan BuildWorker::Impl::plan() const {
  const TileTree& tree = tiles->tree;
  const std::uint64_t leaf = largest_leaf(tree, {0, 0, 0});
  BuildPlan plan;
  plan.tile_side = tree.side();
  plan.leaves = tree.leaves();
  plan.levels = tree.levels();
  plan.memory = memory;
  plan.tile_bytes = tile_bytes_of(memory.kind);
  plan.memory_for_tiles = memory.for_tiles(anonymous_bytes_now(), 1);
  plan.memory_expected = memory.limit - plan.memory_for_tiles +
                         std::max(plan.tile_bytes.of_batch(leaf), plan.tile_bytes.of_replay(leaf));
  return plan;
}

/// Has freed memory given back to the system where a task would not fit beside it.
void BuildWorker::Impl::make_room(std::uint64_t bytes) const {
  if (resources.observer != nullptr && anonymous_bytes_now() + bytes > memory.limit) {
    resources.observer->give_back_memory();
  }
}

BuildWorker::BuildWorker(const std::vector<std::string>& inputs, const BuildOptions& options,
                         const BuildResources& resources, const std::string& note)
    : impl_(std::make_unique<Impl>(inputs, options, resources, note_in(note))) {}

BuildWorker::~BuildWorker() = default;

TaskWorker& BuildWorker::tasks() noexcept { return *impl_->worker; }
const TileTree& BuildWorker::tree() const noexcept { return impl_->tiles->tree; }

TaskMemory BuildWorker::memory(int threads) const {
  const MemoryPlan& all = impl_->memory;
  return {tile_bytes_of(all.kind), all.for_tiles(anonymous_bytes_now(), threads), all.gdal_cache};
}

std::string BuildWorker::answer(const std::string& message) {
  try {
    Task task = task_in_message(message);
    task.stop = impl_->resources.stop;
    if (!impl_->tiles) {
      task.bytes =
          impl_->memory.sorting;  // the memory of this process, not of the one that directs
    } else {
      impl_->make_room(task.bytes);
    }
    return answer_to(task, *impl_->worker);
  } catch (...) {
    return answer_of(error_in_flight());
  }
}

}  // namespace ptin
