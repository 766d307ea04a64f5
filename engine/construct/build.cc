// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include "engine/construct/build_job.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/raster/raster_tile.h"
#include "engine/construct/read/tin_soup.h"
#include "engine/construct/store_output.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {

using namespace build_internal;

namespace {

void build_raster(Job& job) {
  nlohmann::json began_with = fingerprint(job);  // before the first look into the inputs
  const GdalCacheLimit cache(share_memory(job.memory(), 0, 1).gdal_cache);
  const RasterSource source = RasterSource::open(job.inputs, job.source_options(),
                                                 job.resources.stop, job.stage("reading"));
  job.report.source_samples = source.valid_samples();
  job.report.void_samples = source.void_samples();
  job.report.height_rounding = source.frame().height_rounding;
  job.report.vertices =
      static_cast<std::uint64_t>(source.width()) * static_cast<std::uint64_t>(source.height());
  const MeasureUnits units = measure_units(source.frame(), job.options.void_slope);
  const auto make_starter = [&source, units]() -> LeafStarter {
    const auto own = std::make_shared<const RasterSource>(source.duplicate());
    return
        [own, units](const SampleRange& window) { return start_raster_tile(*own, window, units); };
  };
  const std::int64_t side =
      job.options.tile.value_or(TileTree::default_side(source.width(), source.height()));
  const Terrain terrain{source.frame(), units, TileTree(source.width(), source.height(), side),
                        make_starter};
  const BuildPlan plan =
      plan_build(terrain.tree, job.output, job.options, job.resources, TileBytes{}, {});
  if (job.resources.plan) {
    job.resources.plan(plan);
  }
  if (job.resources.dry_run) {
    return;
  }
  // Of a source that is no file, this much at least can be compared.
  began_with["size"] = {source.width(), source.height(), terrain.tree.side()};
  began_with["samples"] = source.valid_samples();
  in_workspace(job, began_with,
               [&](Workspace& workspace) { build_tiles(workspace, job, terrain, plan); });
}

/// @throws Error invalid_argument for options that mean nothing
void check_options(const BuildOptions& o) {
  const auto require = [](bool holds, const char* message) {
    if (!holds) {
      throw Error(ErrorCode::invalid_argument, message);
    }
  };
  const auto is_length = [](double v) { return std::isfinite(v) && v >= 0.0; };
  require(is_length(o.max_error), "the largest error to leave out must be a finite number >= 0");
  require(is_length(o.void_slope), "the void slope must be a finite number >= 0");
  require(!o.resolution || (is_length(*o.resolution) && *o.resolution > 0.0),
          "the resolution must be a finite number > 0");
  require(!o.max_edge || (is_length(*o.max_edge) && *o.max_edge > 0.0),
          "the longest edge must be a finite number > 0");
  require(!o.bbox || ((*o.bbox)[0] < (*o.bbox)[2] && (*o.bbox)[1] < (*o.bbox)[3]),
          "the bbox is inverted or empty; its order is xmin ymin xmax ymax");
  require(!o.tile || (*o.tile >= 2 && *o.tile <= (std::int64_t{1} << 20)),
          "a tile must be 2 to 1,048,576 grid units along a side");
}

/// True for points, false for rasters.
bool are_points(const std::vector<std::string>& inputs, const PointChoice& choice) {
  if (inputs.empty()) {
    throw Error(
        ErrorCode::invalid_argument,
        "no input; name a raster that GDAL reads, or points as LAS, text or a layer that OGR "
        "reads, or a TIN");
  }
  const auto points = std::count_if(inputs.begin(), inputs.end(), [&](const std::string& input) {
    return is_point_input(input, choice);
  });
  if (points != 0 && static_cast<std::size_t>(points) != inputs.size()) {
    throw Error(ErrorCode::invalid_argument,
                "rasters and points together; build from one kind at a time");
  }
  return points != 0;
}

BuildReport build_of_kind(const std::vector<std::string>& inputs, const std::string& output,
                          const BuildOptions& options, const BuildResources& resources) {
  const auto begin = std::chrono::steady_clock::now();
  check_options(options);
  Job job{inputs, output, options, resources, {}};
  if (resources.unfinished == Unfinished::kRefuse && !resources.dry_run) {
    Workspace::refuse_unfinished(output);  // rasters are read before their plan is known
  }
  if (!options.repair && std::any_of(inputs.begin(), inputs.end(), is_tin_file)) {
    build_tin(job);
  } else if (are_points(inputs, job.source_options().points)) {
    build_points(job);
  } else {
    build_raster(job);
  }
  job.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return job.report;
}

}  // namespace

BuildReport build(const std::vector<std::string>& inputs, const std::string& output,
                  const BuildOptions& options, const BuildResources& resources) {
  try {
    return build_of_kind(inputs, output, options, resources);
  } catch (const Error&) {
    throw;
  } catch (...) {  // before the work began, or after it
    const Error e = error_in_flight();
    const Error named(e.code(), e.message(), e.context().empty() ? output : e.context());
    const std::string folder = Workspace::folder_of(output);
    throw is_there(folder) ? told_as_kept(named, folder) : named;
  }
}

}  // namespace ptin
