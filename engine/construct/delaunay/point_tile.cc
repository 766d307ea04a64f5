// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay/point_tile.h"

#include <utility>

namespace ptin {

PointTileStarter::PointTileStarter(const PointBuckets& buckets, const TileTree& tree,
                                   const MeasureUnits& units, std::optional<double> longest_edge,
                                   std::stop_token stop)
    : buckets_(buckets),
      tree_(tree),
      units_(units),
      tiler_(buckets, longest_edge),
      stop_(std::move(stop)) {
  if (longest_edge || buckets.fixed_edges().has_boundary()) {
    ground_.emplace(buckets.frame());
  }
}

StartedTile PointTileStarter::start(const SampleRange& window) {
  __extension__ using Uint128 = unsigned __int128;
  const std::uint64_t leaf = tree_.leaf_number(window);
  const auto begin_of = [&](std::uint64_t i) {
    return static_cast<std::uint64_t>(Uint128{buckets_.size()} * i / tree_.leaves());
  };
  DelaunayTile part = tiler_.make(begin_of(leaf), begin_of(leaf + 1) - begin_of(leaf), stop_);
  StartedTile started = start_part(std::move(part.tin), units_, *tree_.hull(),
                                   ground_ ? &*ground_ : nullptr, part.fixed_sides);
  started.lone_samples = part.lone_points;
  return started;
}

}  // namespace ptin
