// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "engine/construct/delaunay.h"
#include "engine/construct/point_source.h"
#include "engine/construct/raster_source.h"
#include "engine/construct/raster_tile.h"
#include "engine/construct/simplify.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tin_surface.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// A terrain as one tile, ready to be simplified.
struct OpenedTerrain {
  TerrainFrame frame;
  StartedTile started;
};

SourceOptions source_options(const BuildOptions& o) {
  SourceOptions options;
  options.nodata = o.nodata;
  options.resolution = o.resolution;
  if (o.bbox) {
    options.bbox = {(*o.bbox)[0], (*o.bbox)[1], (*o.bbox)[2], (*o.bbox)[3]};
  }
  options.a_srs = o.a_srs;
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

OpenedTerrain open_raster(const std::vector<std::string>& inputs, const BuildOptions& options,
                          const BuildResources& resources, BuildReport& report) {
  const RasterSource source = RasterSource::open(inputs, source_options(options), resources.stop,
                                                 stage(resources, "reading"));
  OpenedTerrain terrain;
  terrain.frame = source.frame();
  terrain.started = start_raster_tile(source, {0, 0, source.width(), source.height()},
                                      measure_units(terrain.frame, options.void_slope));
  report.source_samples = source.valid_samples();
  report.void_samples = source.void_samples();
  report.lone_samples = terrain.started.lone_samples;
  return terrain;
}

OpenedTerrain open_points(const std::vector<std::string>& inputs, const BuildOptions& options,
                          const BuildResources& resources, BuildReport& report) {
  const PointSet points =
      read_points(inputs, source_options(options), resources.stop, stage(resources, "reading"));
  OpenedTerrain terrain;
  terrain.frame = points.frame;
  Tile& tile = terrain.started.tile;
  tile.units = measure_units(terrain.frame, options.void_slope);
  tile.tin = make_delaunay_tin(points.positions, points.heights, resources.stop);
  start_tile(tile, {});
  terrain.started.full = std::make_unique<TinSurface>(tile.tin, terrain.frame.heights);
  report.source_samples = points.positions.size();
  report.merged_points = points.merged_points;
  report.largest_shift_plan = points.largest_shift_plan;
  report.largest_shift_height = points.largest_shift_height;
  return terrain;
}

OpenedTerrain open_terrain(const std::vector<std::string>& inputs, const BuildOptions& options,
                           const BuildResources& resources, BuildReport& report) {
  if (inputs.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "no input; name a raster that GDAL reads, or points as CSV or XYZ text");
  }
  const auto points = std::count_if(inputs.begin(), inputs.end(), is_point_file);
  if (points != 0 && static_cast<std::size_t>(points) != inputs.size()) {
    throw Error(ErrorCode::invalid_argument,
                "rasters and point files together; build from one kind at a time");
  }
  return points != 0 ? open_points(inputs, options, resources, report)
                     : open_raster(inputs, options, resources, report);
}

}  // namespace

BuildReport build(const std::vector<std::string>& inputs, const std::string& output,
                  const BuildOptions& options, const BuildResources& resources) {
  const auto begin = std::chrono::steady_clock::now();
  BuildReport report;
  OpenedTerrain terrain = open_terrain(inputs, options, resources, report);
  report.height_rounding = terrain.frame.height_rounding;
  Tile& tile = terrain.started.tile;
  report.vertices = tile.tin.vertices.size();

  // Made before the long work, so that a target that cannot be written is known at once.
  StoreOutput store(output, options, resources.overwrite, terrain.frame);
  SimplifyOptions simplify_options;
  simplify_options.cost = options.cost;
  simplify_options.stop = resources.stop;
  const auto report_collapses = stage(resources, "collapsing");
  simplify_options.progress = [&](std::uint64_t collapsed) {
    report_collapses(collapsed, report.vertices);
  };
  simplify(tile, *terrain.started.full, simplify_options);
  terrain.started.full.reset();
  stage(resources, "writing")(0, 1);
  store.add_segment(tile.records);
  store.publish(tile.tin, inputs, report);
  stage(resources, "writing")(1, 1);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

}  // namespace ptin
