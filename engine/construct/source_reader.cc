// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/source_reader.h"

#include "engine/construct/build_job.h"
#include "engine/construct/build_note.h"
#include "engine/construct/grid/source_stage.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/points/point_tasks.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/source_kind.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/error.h"

namespace ptin {

using namespace build_internal;

namespace {

std::unique_ptr<StageWorker> worker_of(InputKind kind, const std::vector<std::string>& inputs,
                                       const BuildOptions& options, const BuildNote& note,
                                       const BuildResources& resources) {
  if (kind == InputKind::kRaster) {
    return RasterSource::open_to_scan(inputs, source_options_of(options));
  }
  if (kind == InputKind::kPoints) {
    require_shared_folders(note, resources);
    FileLayer& files = resources.files != nullptr ? *resources.files : FileLayer::system();
    const auto await = [patience = resources.patience, stop = resources.stop](
                           const std::string& path) { await_file(path, patience, stop); };
    return std::make_unique<PointTasks>(inputs, source_options_of(options),
                                        PointFiles{files, note.temporary, await, true});
  }
  throw Error(ErrorCode::internal, "this kind of source is read by one process");
}

}  // namespace

struct SourceReader::Impl {
  Impl(const std::vector<std::string>& inputs, const BuildOptions& options,
       const BuildResources& given, const BuildNote& note)
      : resources(given),
        memory(plan_memory(given.memory_bytes, source_kind(inputs, options))),
        cache(memory.gdal_cache) {
    require_same_inputs(note, inputs, options);
    worker = worker_of(memory.kind, inputs, options, note, resources);
  }

  BuildResources resources;
  MemoryPlan memory;
  GdalCacheLimit cache;
  std::unique_ptr<StageWorker> worker;
};

SourceReader::SourceReader(const std::vector<std::string>& inputs, const BuildOptions& options,
                           const BuildResources& resources, const std::string& note)
    : impl_(std::make_unique<Impl>(inputs, options, resources, note_in(note))) {}

SourceReader::~SourceReader() = default;

std::string SourceReader::answer(const std::string& message) {
  try {
    return answer_to(message, *impl_->worker, impl_->memory.sorting, impl_->resources.stop);
  } catch (...) {
    return answer_of(error_in_flight());
  }
}

}  // namespace ptin
