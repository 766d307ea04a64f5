// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds a raster tile by tile: collapses from the leaves to the root, then tightens from the root
// to the leaves (DESIGN.md, section 5).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/cost.h"
#include "engine/construct/raster_tile.h"
#include "engine/construct/segment.h"
#include "engine/construct/tile_push.h"
#include "engine/construct/tile_tree.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// Receives finished segments, in an order that depends on the tree alone; may reorder them in
/// place.
using SegmentSink = std::function<void(std::span<VertexSplit>)>;

/// Starts a leaf: all samples of a window and the full surface under it, the same whenever it is
/// called. Each leaf is started twice: for its collapses and for tightening.
using LeafStarter = std::function<StartedTile(const SampleRange&)>;

struct HierarchyOptions {
  CostModel cost = CostModel::kError;
  std::stop_token stop;
  std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)> progress;
};

/// One build. Segments of leaves are final when the leaf is collapsed, since a leaf measures all
/// its samples; those of inner tiles, a quarter of all records, wait for tightening.
class HierarchyBuilder {
 public:
  HierarchyBuilder(LeafStarter start_leaf, const TileTree& tree, const HierarchyOptions& options,
                   SegmentSink sink);

  /// Builds everything; returns the coarsest TIN, every vertex alive.
  /// @throws Error as simplify(), and what the starter and the sink throw
  [[nodiscard]] Tin run();

  [[nodiscard]] std::uint64_t lone_samples() const noexcept { return lone_samples_; }

 private:
  [[nodiscard]] PushedTile build(const TileId& id);
  [[nodiscard]] PushedTile build_leaf(const TileId& id);
  [[nodiscard]] PushedTile build_inner(const TileId& id);
  [[nodiscard]] std::uint64_t vertices_to_keep(const Tile& tile, const TileId& id) const;
  std::vector<RecordBounds> tighten(const TileId& id, std::vector<InnerSegment*>& chain,
                                    const Tin& t0);
  void report(const char* stage, std::uint64_t done, std::uint64_t total);

  LeafStarter start_leaf_;
  TileTree tree_;
  HierarchyOptions options_;
  SegmentSink sink_;
  std::map<TileId, InnerSegment> segments_;
  std::uint64_t lone_samples_ = 0;
  std::uint64_t leaves_done_ = 0;
};

}  // namespace ptin
