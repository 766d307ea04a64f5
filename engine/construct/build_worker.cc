// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_worker.h"

#include "engine/construct/build_job.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/source_kind.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tasks/task_worker.h"
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
        source(inputs, options, note.index, note.temporary, files, given.stop),
        packer(options, source.tiled().frame, files, note.folder),
        worker({source.tiled().tree, collapse_options(options, source.tiled()),
                source.tiled().make_starter, packer, files, note.temporary, true},
               [](TaskKind, std::uint64_t) {}) {}

  BuildResources resources;
  FileLayer& files;
  MemoryPlan memory;
  GdalCacheLimit cache;
  ReadSource source;
  StorePacker packer;
  TaskWorker worker;
};

BuildWorker::BuildWorker(const std::vector<std::string>& inputs, const BuildOptions& options,
                         const BuildResources& resources, const std::string& note)
    : impl_(std::make_unique<Impl>(inputs, options, resources, note_in(note))) {}

BuildWorker::~BuildWorker() = default;

std::string BuildWorker::answer(const std::string& message, std::size_t thread) {
  try {
    if (impl_->resources.observer != nullptr) {
      impl_->resources.observer->give_back_memory();
    }
    return answer_to(message, impl_->worker, thread, impl_->resources.stop);
  } catch (...) {
    return answer_of(error_in_flight());
  }
}

}  // namespace ptin
