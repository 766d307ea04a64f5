// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build works on, of whatever kind its source is, and how another process of the same build
// takes up a source that was read already.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/build_options.h"
#include "engine/construct/delaunay/point_tile.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/error.h"
#include "storage/store_writer.h"

namespace ptin::build_internal {

/// A terrain in tiles.
struct TiledSource {
  TerrainFrame frame;
  MeasureUnits units;
  TileTree tree;
  std::function<LeafStarter()> make_starter;  ///< Called once for each task that runs at once.
  /// Gives the samples of a raster to the file; empty: the source is none.
  std::function<KeptRaster(StoreWriter&, const std::stop_token&)> add_floor = {};
};

/// @param source  Must outlive the result.
[[nodiscard]] TiledSource tiled(const RasterSource& source, const BuildOptions& options);
[[nodiscard]] TiledSource tiled(const PointBuckets& points, const BuildOptions& options,
                                const std::stop_token& stop);
[[nodiscard]] TiledSource tiled(const TinTriangles& triangles, const BuildOptions& options);

/// What the tiles of a source are collapsed with.
[[nodiscard]] CollapseOptions collapse_options(const BuildOptions& options,
                                               const TiledSource& source);

// Where what was read of a source lies in a build's folder of temporary files.
inline constexpr const char* kRasterIndex = "raster.index";
inline constexpr const char* kPointBuckets = "points";
inline constexpr const char* kPointsIndex = "points.index";
inline constexpr const char* kTinTriangles = "tin";
inline constexpr const char* kTinIndex = "tin.index";

/// True where an error is that a file of a sorted source, in a folder of temporary files, cannot be read
/// back: damaged, cut, gone, or on a disk that fails. It can be sorted again from the inputs.
[[nodiscard]] bool is_lost_sorted_source(const Error& error, const std::string& folder);

/// A source that another process has read: of a raster it knows the frame, of points and TINs it reads
/// what was sorted. The starters own it.
/// @param index   The facts of the source's index, by the name of its kind: {"raster": [bytes,
///                checksum]}, as index_json() made it.
/// @param folder  The build's folder of temporary files.
/// @throws Error corruption  the index is not what was written; as RasterSource::take_up() and
///               its like
[[nodiscard]] TiledSource take_up_source(const std::vector<std::string>& inputs,
                                         const BuildOptions& options, const nlohmann::json& index,
                                         const std::string& folder, FileLayer& files,
                                         const std::stop_token& stop);

}  // namespace ptin::build_internal
