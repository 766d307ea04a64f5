// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/construct/delaunay.h"
#include "engine/construct/hierarchy.h"
#include "engine/construct/point_source.h"
#include "engine/construct/raster_source.h"
#include "engine/construct/raster_tile.h"
#include "engine/construct/simplify.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tin_surface.h"
#include "engine/error.h"

namespace ptin {

namespace {

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

void build_raster(Job& job) {
  const RasterSource source = RasterSource::open(
      job.inputs, source_options(job.options), job.resources.stop, stage(job.resources, "reading"));
  job.report.source_samples = source.valid_samples();
  job.report.void_samples = source.void_samples();
  job.report.height_rounding = source.frame().height_rounding;
  job.report.vertices =
      static_cast<std::uint64_t>(source.width()) * static_cast<std::uint64_t>(source.height());

  // Made before the long work, so that a target that cannot be written is known at once.
  StoreOutput store(job.output, job.options, job.resources.overwrite, source.frame());
  HierarchyOptions options;
  options.cost = job.options.cost;
  options.stop = job.resources.stop;
  options.progress = job.resources.progress;
  const TileTree tree(
      source.width(), source.height(),
      job.options.tile.value_or(TileTree::default_side(source.width(), source.height())));
  const MeasureUnits units = measure_units(source.frame(), job.options.void_slope);
  HierarchyBuilder builder(
      [&](const SampleRange& window) { return start_raster_tile(source, window, units); }, tree,
      options, [&](std::span<VertexSplit> records) { store.add_segment(records); });
  const Tin t0 = builder.run();
  job.report.lone_samples = builder.lone_samples();
  stage(job.resources, "writing")(0, 1);
  store.publish(t0, job.inputs, job.report);
}

void build_points(Job& job) {
  const PointSet points = read_points(job.inputs, source_options(job.options), job.resources.stop,
                                      stage(job.resources, "reading"));
  job.report.source_samples = points.positions.size();
  job.report.left_out_points = points.left_out_points;
  job.report.merged_points = points.merged_points;
  job.report.largest_shift_plan = points.largest_shift_plan;
  job.report.largest_shift_height = points.largest_shift_height;
  job.report.height_rounding = points.frame.height_rounding;
  job.report.vertices = points.positions.size();

  StoreOutput store(job.output, job.options, job.resources.overwrite, points.frame);
  Tile tile;
  tile.units = measure_units(points.frame, job.options.void_slope);
  tile.tin = make_delaunay_tin(points.positions, points.heights, job.resources.stop);
  start_tile(tile, {});
  const TinSurface full(tile.tin, points.frame.heights);
  SimplifyOptions options;
  options.cost = job.options.cost;
  options.stop = job.resources.stop;
  const auto report_collapses = stage(job.resources, "collapsing");
  options.progress = [&](std::uint64_t collapsed) {
    report_collapses(collapsed, job.report.vertices);
  };
  simplify(tile, full, options);
  stage(job.resources, "writing")(0, 1);
  store.add_segment(tile.records);
  store.publish(tile.tin, job.inputs, job.report);
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
  require(!o.bbox || ((*o.bbox)[0] < (*o.bbox)[2] && (*o.bbox)[1] < (*o.bbox)[3]),
          "the bbox is inverted or empty; its order is xmin ymin xmax ymax");
  require(!o.tile || *o.tile >= 2, "a tile must be at least 2 grid units along a side");
}

/// True for points, false for rasters.
bool are_points(const std::vector<std::string>& inputs, const PointChoice& choice) {
  if (inputs.empty()) {
    throw Error(
        ErrorCode::invalid_argument,
        "no input; name a raster that GDAL reads, or points as LAS, text or a layer that OGR "
        "reads");
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
  if (are_points(inputs, source_options(options).points)) {
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
