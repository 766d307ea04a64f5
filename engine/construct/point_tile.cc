// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/point_tile.h"

#include <cmath>
#include <memory>
#include <utility>

#include "engine/construct/part_surface.h"

namespace ptin {

namespace {

std::optional<double> in_grid_units(std::optional<double> length, const AffineMap& map) {
  return length ? std::optional(*length / map.step_x) : std::nullopt;
}

}  // namespace

PointTileStarter::PointTileStarter(const PointBuckets& buckets, const TileTree& tree,
                                   const MeasureUnits& units, std::optional<double> longest_edge,
                                   std::stop_token stop)
    : buckets_(buckets),
      tree_(tree),
      units_(units),
      tiler_(buckets, in_grid_units(longest_edge, buckets.frame().map),
             buckets.frame().map.step_y / buckets.frame().map.step_x),
      stop_(std::move(stop)) {}

StartedTile PointTileStarter::start(const SampleRange& window) {
  __extension__ using Uint128 = unsigned __int128;
  const std::uint64_t leaf = tree_.leaf_number(window);
  const auto begin_of = [&](std::uint64_t i) {
    return static_cast<std::uint64_t>(Uint128{buckets_.size()} * i / tree_.leaves());
  };
  DelaunayTile part = tiler_.make(begin_of(leaf), begin_of(leaf + 1) - begin_of(leaf), stop_);
  StartedTile started;
  started.tile.units = units_;
  started.tile.tin = std::move(part.tin);
  started.lone_samples = part.lone_points;
  start_tile(started.tile, {});
  for (const Vertex& v : started.tile.tin.vertices) {
    started.box = united(started.box, v.position);
  }
  started.full = std::make_unique<PartSurface>(started.tile.tin, units_.heights);
  return started;
}

TileTree point_tree(const PointBuckets& buckets, std::optional<std::int64_t> side) {
  const auto across =
      static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(buckets.size()))));
  return TileTree::over_points(buckets.size(),
                               side.value_or(TileTree::default_side(across, across)),
                               std::make_shared<const ConvexHull>(buckets.hull()));
}

}  // namespace ptin
