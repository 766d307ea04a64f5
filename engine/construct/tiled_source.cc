// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tiled_source.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "engine/construct/collapse/first_pass.h"
#include "engine/construct/raster/raster_floor.h"
#include "engine/construct/raster/raster_tile.h"
#include "engine/construct/tasks/task.h"
#include "engine/construct/tin/tin_tile.h"
#include "engine/error.h"

namespace ptin::build_internal {

TiledSource tiled(const RasterSource& source, const BuildOptions& options) {
  const MeasureUnits units = measure_units(source.frame(), options.void_slope);
  const std::int64_t side =
      options.tile.value_or(TileTree::default_side(source.width(), source.height()));
  const bool thins_sides = options.max_error > 0.0 && side % 32 == 0 && side >= 64;
  const auto make_starter = [&source, units, thins_sides]() -> LeafStarter {
    const auto own = std::make_shared<const RasterSource>(source.duplicate());
    return [own, units, thins_sides](const SampleRange& window) {
      return start_raster_tile(*own, window, units, thins_sides);
    };
  };
  const auto add_floor = [&source](StoreWriter& writer, const std::stop_token& stop) {
    return add_raster_floor(source, writer, stop);
  };
  return {source.frame(), units, TileTree(source.width(), source.height(), side), make_starter,
          add_floor};
}

TiledSource tiled(const PointBuckets& points, const BuildOptions& options,
                  const std::stop_token& stop) {
  const MeasureUnits units = measure_units(points.frame(), options.void_slope);
  const auto tree = std::make_shared<const TileTree>(TileTree::over_points(
      points.size(), options.tile, std::make_shared<const ConvexHull>(points.hull())));
  const auto make_starter = [&points, tree, units, longest = options.max_edge,
                             stop]() -> LeafStarter {
    const auto starter = std::make_shared<PointTileStarter>(points, *tree, units, longest, stop);
    return [tree, starter](const SampleRange& window) { return starter->start(window); };
  };
  return {points.frame(), units, *tree, make_starter};
}

TiledSource tiled(const TinTriangles& triangles, const BuildOptions& options) {
  const MeasureUnits units = measure_units(triangles.frame(), options.void_slope);
  const auto tree = std::make_shared<const TileTree>(
      TileTree::over_points(triangles.counts().vertices, options.tile,
                            std::make_shared<const ConvexHull>(triangles.hull())));
  const auto make_starter = [&triangles, tree, units]() -> LeafStarter {
    return [&triangles, tree, units](const SampleRange& window) {
      return start_tin_tile(triangles, *tree, window, units);
    };
  };
  return {triangles.frame(), units, *tree, make_starter};
}

CollapseOptions collapse_options(const BuildOptions& options, const TiledSource& source) {
  CollapseOptions result;
  result.cost = options.cost;
  result.units = source.units;
  result.first_pass = (kFirstPassShare * options.max_error - source.frame.height_rounding) /
                      source.frame.heights.step;
  return result;
}

bool is_lost_sorted_source(const Error& error, const std::string& folder) {
  const bool is_lost = error.code() == ErrorCode::corruption ||
                       error.code() == ErrorCode::not_found || error.code() == ErrorCode::io_error;
  return is_lost && (error.context().starts_with(folder + "/" + kPointBuckets) ||
                     error.context().starts_with(folder + "/" + kTinTriangles));
}

namespace {

/// The tiles of a source that goes with their starters.
template <class Source, class... More>
TiledSource tiled_and_kept(Source&& source, const BuildOptions& options, const More&... more) {
  const auto kept = std::make_shared<const Source>(std::forward<Source>(source));
  TiledSource tiles = tiled(*kept, options, more...);
  tiles.make_starter = [kept, make = std::move(tiles.make_starter)] { return make(); };
  return tiles;
}

}  // namespace

TiledSource take_up_source(const std::vector<std::string>& inputs, const BuildOptions& options,
                           const nlohmann::json& index, const std::string& folder, FileLayer& files,
                           const std::stop_token& stop) {
  const auto facts = [&](const char* kind) { return array_facts_in(index.at(kind)); };
  const auto path = [&](const char* name) { return folder + "/" + name; };
  if (index.contains("raster")) {
    return tiled_and_kept(RasterSource::take_up(inputs, source_options_of(options),
                                                path(kRasterIndex), facts("raster")),
                          options);
  }
  if (index.contains("points")) {
    return tiled_and_kept(
        PointBuckets::load(files, path(kPointBuckets), path(kPointsIndex), facts("points")),
        options, stop);
  }
  return tiled_and_kept(
      TinTriangles::load(files, path(kTinTriangles), path(kTinIndex), facts("tin")), options);
}

}  // namespace ptin::build_internal
