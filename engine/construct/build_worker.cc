// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_worker.h"

#include <algorithm>

#include "engine/construct/build_job.h"
#include "engine/construct/build_note.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/source_kind.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/construct/tile_tasks/tile_worker.h"
#include "engine/construct/tiled_source.h"

namespace ptin {

using namespace build_internal;

struct BuildWorker::Impl {
  Impl(const std::vector<std::string>& inputs, const BuildOptions& options,
       const BuildResources& given, const BuildNote& note)
      : resources(given),
        files(given.files != nullptr ? *given.files : FileLayer::system()),
        memory(plan_memory(given.memory_bytes, source_kind(inputs, options))),
        cache(memory.gdal_cache),
        source(inputs, options,
               require_same_inputs(require_shared_folders(note, given), inputs, options).index,
               note.temporary, files, given.stop),
        packer(options, source.tiled().frame, files, note.folder),
        worker({source.tiled().tree, collapse_options(options, source.tiled()),
                source.tiled().make_starter, packer, files, note.temporary, true, given.patience},
               [](TaskKind, std::uint64_t) {}) {
    if (resources.observer != nullptr) {
      resources.observer->plan(plan());
    }
  }
  [[nodiscard]] BuildPlan plan() const;
  void make_room(std::uint64_t bytes) const;

  BuildResources resources;
  FileLayer& files;
  MemoryPlan memory;
  GdalCacheLimit cache;
  ReadSource source;
  StorePacker packer;
  TaskWorker worker;
};

/// What one task at a time takes here, the last join apart.
BuildPlan BuildWorker::Impl::plan() const {
  const TileTree& tree = source.tiled().tree;
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

TaskWorker& BuildWorker::tasks() noexcept { return impl_->worker; }
const TileTree& BuildWorker::tree() const noexcept { return impl_->source.tiled().tree; }

std::string BuildWorker::answer(const std::string& message, std::size_t thread) {
  try {
    impl_->make_room(bytes_of_task(message));
    return answer_to(message, impl_->worker, thread, impl_->resources.stop);
  } catch (...) {
    return answer_of(error_in_flight());
  }
}

}  // namespace ptin
