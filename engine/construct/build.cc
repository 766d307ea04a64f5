// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <tuple>
#include <utility>

#include "engine/construct/build_job.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/kept_inputs.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/source_files.h"
#include "engine/construct/source_kind.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tiled_source.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {

using namespace build_internal;

namespace {

void build_raster(Job& job) {
  nlohmann::json began_with = fingerprint(job);  // before the first look into the inputs
  const GdalCacheLimit cache(job.memory.gdal_cache);
  std::ignore = job.begin({}, nullptr);
  const RasterSource source = RasterSource::open(job.inputs, job.source_options(), job.run_tasks());
  job.report.source_samples = source.valid_samples();
  job.report.warnings.join(source.warnings());
  job.report.void_samples = source.void_samples();
  job.report.height_rounding = source.frame().height_rounding;
  job.report.vertices =
      static_cast<std::uint64_t>(source.width()) * static_cast<std::uint64_t>(source.height());
  const TiledSource tiles = tiled(source, job.options);
  const BuildPlan plan = plan_build(tiles.tree, job.plan_request({}));
  job.tell(plan);
  if (job.resources.dry_run) {
    return;
  }
  // The size and the number of samples can be compared even where the source is no file.
  began_with["size"] = {source.width(), source.height(), tiles.tree.side()};
  began_with["samples"] = source.valid_samples();
  in_workspace(job, began_with, [&](Workspace& workspace) {
    const ArrayFileFacts index = source.save(job.files(), workspace.temporary(kRasterIndex));
    build_tiles(workspace, job, tiles, plan, index_json("raster", index));
  });
}

BuildReport build_of_kind(const std::vector<std::string>& inputs, const std::string& output,
                          const BuildOptions& options, const BuildResources& resources) {
  const auto begin = std::chrono::steady_clock::now();
  check_options(options);
  check_inputs_are_kept(all_inputs(inputs, options), output);
  const InputKind kind = source_kind(inputs, options);
  Job job{inputs, output, options, resources, plan_memory(resources.memory_bytes, kind), {}};
  if (resources.unfinished == Unfinished::kRefuse && !resources.dry_run) {
    Workspace::refuse_unfinished(output);  // rasters are read before their plan is known
  }
  // Nothing may fail any more when the output is there.
  warn_of_repeated(inputs, job.report.warnings);
  switch (kind) {
    case InputKind::kRaster:
      build_raster(job);
      break;
    case InputKind::kPoints:
      build_points(job);
      break;
    case InputKind::kTin:
      build_tin(job);
      break;
  }
  job.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return std::move(job.report);
}

}  // namespace

BuildReport build(const std::vector<std::string>& inputs, const std::string& output,
                  const BuildOptions& options, const BuildResources& resources) {
  try {
    return build_of_kind(with_folders_opened(inputs), output, options, resources);
  } catch (const Error&) {
    throw;
  } catch (...) {  // before the work began, or after it
    const Error e = error_in_flight();
    const Error named(e.code(), e.message(), e.context().empty() ? output : e.context());
    const std::string folder = Workspace::folder_of(output);
    throw is_there(folder) ? with_resume_hint(named, folder) : named;
  }
}

}  // namespace ptin
