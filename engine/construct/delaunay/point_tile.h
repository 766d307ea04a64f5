// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile that starts from points in buckets.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Starts the leaves of a terrain of points, one after the other. Not thread-safe: each thread
/// needs a starter of its own; any number of them may share the buckets.
class PointTileStarter {
 public:
  /// @param buckets, tree  Must live as long as this.
  /// @param longest_edge   As DelaunayTiler.
  PointTileStarter(const PointBuckets& buckets, const TileTree& tree, const MeasureUnits& units,
                   std::optional<double> longest_edge, std::stop_token stop = {});

  /// Starts the leaf that has this window: its part of the one Delaunay triangulation
  /// (delaunay/tile_delaunay.h), and its part of the full surface.
  /// @throws Error as DelaunayTiler::make()
  [[nodiscard]] StartedTile start(const SampleRange& window);

 private:
  const PointBuckets& buckets_;
  const TileTree& tree_;
  MeasureUnits units_;
  DelaunayTiler tiler_;
  std::optional<GroundMetric> ground_;  ///< Where there are voids.
  std::stop_token stop_;
};

}  // namespace ptin
