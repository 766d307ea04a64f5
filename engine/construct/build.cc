// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "engine/construct/hierarchy.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/point_buckets.h"
#include "engine/construct/point_tile.h"
#include "engine/construct/raster_source.h"
#include "engine/construct/raster_tile.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tin_soup.h"
#include "engine/construct/tin_source.h"
#include "engine/construct/tin_tile.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// What a leaf of points takes: its triangulation by CGAL goes before its collapses begin, its copy
/// of the full surface stays.
constexpr TileBytes kPointTileBytes{.collapse_of_sample = 640, .replay_of_sample = 560};

/// One call of build(): what it was asked, and what it reports.
struct Job {
  const std::vector<std::string>& inputs;
  const std::string& output;
  const BuildOptions& options;
  const BuildResources& resources;
  BuildReport report;
};

SourceOptions source_options(const BuildOptions& o) {
  SourceOptions options;
  options.nodata = o.nodata;
  options.resolution = o.resolution;
  if (o.bbox) {
    options.bbox = {(*o.bbox)[0], (*o.bbox)[1], (*o.bbox)[2], (*o.bbox)[3]};
  }
  options.a_srs = o.a_srs;
  options.points = {o.classes, o.layer, o.z_field};
  options.vertical_crs = o.vertical_crs;
  return options;
}

/// A stage of the caller's progress.
auto stage(const BuildResources& resources, const char* name) {
  return [&resources, name](std::uint64_t done, std::uint64_t total) {
    if (resources.progress) {
      resources.progress(name, done, total);
    }
  };
}

/// What a build works on, of whatever kind its source is.
struct Terrain {
  TerrainFrame frame;
  MeasureUnits units;
  TileTree tree;
  std::function<LeafStarter()> make_starter;  ///< Called once for each thread.
  std::uint64_t samples = 0;                  ///< With a height.
};

/// What decides the bytes of the output, and that its inputs are still the ones it began with.
nlohmann::json fingerprint(const Job& job, const Terrain& terrain) {
  nlohmann::json files = nlohmann::json::array();
  for (const std::string& input : job.inputs) {
    std::error_code ignored;  // of inputs that are no files: GDAL knows more than those
    const auto bytes = std::filesystem::file_size(input, ignored);
    const auto time = std::filesystem::last_write_time(input, ignored);
    files.push_back({input, ignored ? 0 : bytes, ignored ? 0 : time.time_since_epoch().count()});
  }
  const SampleRange whole = terrain.tree.window(terrain.tree.root());
  return {{"options", options_json(job.options)}, {"page_bytes", job.options.page_bytes},
          {"tile", terrain.tree.side()},          {"inputs", files},
          {"size", {whole.width, whole.height}},  {"samples", terrain.samples}};
}

/// Collapses and tightens everything into `store`.
Tin build_tiles(Job& job, const Terrain& terrain, const BuildPlan& plan, Workspace& workspace,
                StoreOutput& store) {
  HierarchyOptions options;
  options.collapse.cost = job.options.cost;
  options.collapse.units = terrain.units;
  options.threads = plan.threads;
  options.bytes = plan.tile_bytes;
  options.checkpoint_interval = job.resources.checkpoint_interval;
  options.stop = job.resources.stop;
  options.progress = job.resources.progress;
  BuiltHierarchy built =
      build_hierarchy(terrain.make_starter, terrain.tree, options, workspace, store);
  job.report.lone_samples = built.lone_samples;
  return std::move(built.t0);
}

/// True when an interrupted build had got as far as giving the output its name.
bool is_published(const Job& job, const Workspace& workspace) {
  const std::vector<nlohmann::json> lines = workspace.lines();
  return !lines.empty() && lines.back().contains("publishing") &&
         !std::filesystem::exists(workspace.folder() + "/pages") &&
         std::filesystem::exists(job.output);
}

void build_in(Workspace& workspace, Job& job, const Terrain& terrain, const BuildPlan& plan) {
  job.report.resumed = !workspace.lines().empty();
  if (is_published(job, workspace)) {
    const auto store = StoreFile::open(job.output);
    job.report.records = store->record_count();
    job.report.t0_vertices = store->t0().vertices.size();
    job.report.max_rank = store->max_rank();
    job.report.file_bytes = std::filesystem::file_size(job.output);
    return;
  }
  StoreOutput store(job.output, job.options, job.resources.overwrite, terrain.frame,
                    job.resources.files, workspace.folder());
  const Tin t0 = build_tiles(job, terrain, plan, workspace, store);
  stage(job.resources, "writing")(0, 1);
  workspace.append({{{"publishing", true}}});
  store.publish(t0, job.inputs, job.report);
}

/// Worth keeping: faults of the system, and whatever comes when hours of work may be there.
bool is_kept(const Workspace& workspace, ErrorCode code) {
  return workspace.has_work() || code == ErrorCode::cancelled ||
         code == ErrorCode::resource_exhausted || code == ErrorCode::io_error;
}

FileLayer& files_of(const Job& job) {
  return job.resources.files != nullptr ? *job.resources.files : FileLayer::system();
}

std::uint64_t memory_of(const Job& job) {
  return job.resources.memory_bytes != 0 ? job.resources.memory_bytes : default_memory();
}

void build_terrain(Job& job, const Terrain& terrain, const TileBytes& tile_bytes) {
  const BuildPlan plan =
      plan_build(terrain.tree, job.output, job.options, job.resources, tile_bytes);
  if (job.resources.plan) {
    job.resources.plan(plan);
  }
  if (job.resources.dry_run) {
    return;
  }
  Workspace workspace(files_of(job), job.output, job.resources.tmp, job.resources.unfinished,
                      fingerprint(job, terrain));
  try {
    build_in(workspace, job, terrain, plan);
  } catch (const Error& e) {
    if (is_kept(workspace, e.code())) {
      throw Error(e.code(),
                  e.message() + "; what is done is kept in " + workspace.folder() +
                      ": go on by --resume, or remove it by --discard",
                  e.context());
    }
    workspace.remove_all();
    throw;
  }
  workspace.remove_all();
}

void build_raster(Job& job) {
  const GdalCacheLimit cache(share_memory(memory_of(job), 0, 1).gdal_cache);
  const RasterSource source = RasterSource::open(
      job.inputs, source_options(job.options), job.resources.stop, stage(job.resources, "reading"));
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
  build_terrain(
      job,
      {source.frame(), units,
       TileTree(source.width(), source.height(),
                job.options.tile.value_or(TileTree::default_side(source.width(), source.height()))),
       make_starter, source.valid_samples()},
      TileBytes{});
}

/// Temporary files of points: where those of the tiles will be.
std::string folder_for_points(const Job& job) {
  if (!job.resources.tmp.empty()) {
    return job.resources.tmp;
  }
  const std::string folder = std::filesystem::path(job.output).parent_path().string();
  return folder.empty() ? "." : folder;
}

void build_points(Job& job) {
  const GdalCacheLimit cache(share_memory(memory_of(job), 0, 1).gdal_cache);
  const PointBuckets points =
      PointBuckets::read(job.inputs, source_options(job.options),
                         {files_of(job), folder_for_points(job),
                          std::clamp<std::uint64_t>(memory_of(job) / 8, std::uint64_t{1} << 20,
                                                    std::uint64_t{256} << 20)},
                         job.resources.stop, job.resources.progress);
  job.report.source_samples = points.size();
  job.report.left_out_points = points.counts().left_out_points;
  job.report.merged_points = points.counts().merged_points;
  job.report.largest_shift_plan = points.counts().largest_shift_plan;
  job.report.largest_shift_height = points.counts().largest_shift_height;
  job.report.height_rounding = points.frame().height_rounding;
  job.report.vertices = points.size();
  Terrain terrain{points.frame(),
                  measure_units(points.frame(), job.options.void_slope),
                  point_tree(points, job.options.tile),
                  {},
                  points.size()};
  terrain.make_starter = [&]() -> LeafStarter {
    const auto starter = std::make_shared<PointTileStarter>(
        points, terrain.tree, terrain.units, job.options.max_edge, job.resources.stop);
    return [starter](const SampleRange& window) { return starter->start(window); };
  };
  build_terrain(job, terrain, kPointTileBytes);
}

/// Somebody else's triangles.
void build_tin(Job& job) {
  if (job.inputs.size() != 1) {
    throw Error(ErrorCode::invalid_argument, "several inputs, a TIN among them; build a TIN alone");
  }
  const TinTriangles triangles =
      TinTriangles::read(job.inputs[0], source_options(job.options),
                         {files_of(job), folder_for_points(job),
                          std::max<std::uint64_t>(memory_of(job) / 2, 1U << 20)},
                         job.resources.stop, job.resources.progress);
  const TinCounts& counts = triangles.counts();
  job.report.source_samples = job.report.vertices = counts.vertices;
  job.report.left_out_points = counts.unused_vertices;
  job.report.left_out_triangles = counts.left_out_triangles;
  job.report.void_triangles = counts.void_triangles;
  job.report.merged_points = counts.merged_vertices;
  job.report.largest_shift_plan = counts.largest_shift_plan;
  job.report.height_rounding = triangles.frame().height_rounding;
  Terrain terrain{triangles.frame(),
                  measure_units(triangles.frame(), job.options.void_slope),
                  tin_tree(triangles, job.options.tile),
                  {},
                  counts.vertices};
  terrain.make_starter = [&]() -> LeafStarter {
    return [&](const SampleRange& window) {
      return start_tin_tile(triangles, terrain.tree, window, terrain.units);
    };
  };
  build_terrain(job, terrain, kPointTileBytes);
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

}  // namespace

BuildReport build(const std::vector<std::string>& inputs, const std::string& output,
                  const BuildOptions& options, const BuildResources& resources) {
  const auto begin = std::chrono::steady_clock::now();
  check_options(options);
  Job job{inputs, output, options, resources, {}};
  if (!options.repair && std::any_of(inputs.begin(), inputs.end(), is_tin_file)) {
    build_tin(job);
  } else if (are_points(inputs, source_options(options).points)) {
    build_points(job);
  } else {
    build_raster(job);
  }
  stage(resources, "writing")(1, 1);
  job.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return job.report;
}

}  // namespace ptin
