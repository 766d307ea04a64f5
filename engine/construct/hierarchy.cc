// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy.h"

#include <algorithm>
#include <utility>

#include "engine/construct/simplify.h"
#include "engine/construct/tighten.h"
#include "engine/error.h"

namespace ptin {

HierarchyBuilder::HierarchyBuilder(LeafStarter start_leaf, const TileTree& tree,
                                   const HierarchyOptions& options, SegmentSink sink)
    : start_leaf_(std::move(start_leaf)), tree_(tree), options_(options), sink_(std::move(sink)) {}

void HierarchyBuilder::report(const char* stage, std::uint64_t done, std::uint64_t total) {
  if (options_.stop.stop_requested()) {
    throw Error(ErrorCode::cancelled, "the build was cancelled");
  }
  if (options_.progress) {
    options_.progress(stage, done, total);
  }
}

/// A quarter of the vertices that are not locked; at the root none that can go.
std::uint64_t HierarchyBuilder::vertices_to_keep(const Tile& tile, const TileId& id) const {
  if (id == tree_.root()) {
    return 0;
  }
  const auto free = std::count_if(tile.vertex_state.begin(), tile.vertex_state.end(),
                                  [](const VertexState& v) { return !v.locked; });
  return static_cast<std::uint64_t>(free) / 4;
}

PushedTile HierarchyBuilder::build(const TileId& id) {
  return id.level == 0 ? build_leaf(id) : build_inner(id);
}

PushedTile HierarchyBuilder::build_leaf(const TileId& id) {
  StartedTile leaf = start_leaf_(tree_.window(id));
  lone_samples_ += leaf.lone_samples;
  lock_seams(leaf.tile, tree_, id);
  SimplifyOptions options;
  options.cost = options_.cost;
  options.keep = vertices_to_keep(leaf.tile, id);
  options.stop = options_.stop;
  simplify(leaf.tile, *leaf.full, options);
  leaf.full.reset();
  std::vector<VertexSplit> records = leaf.tile.records;
  PushedTile pushed = push_up(std::move(leaf.tile));
  sink_(records);
  report("collapsing", ++leaves_done_, tree_.leaves());
  return pushed;
}

PushedTile HierarchyBuilder::build_inner(const TileId& id) {
  InnerSegment segment;
  segment.id = id;
  std::vector<Tile> parts;
  for (const TileId& child : tree_.children(id)) {
    PushedTile pushed = build(child);
    segment.child_begin.push_back(static_cast<std::uint32_t>(segment.foreign.size()));
    for (const VertexSplit& r : pushed.tile.records) {
      segment.foreign.push_back({r.error, r.deviation});
    }
    parts.push_back(std::move(pushed.tile));
    if (child.level > 0) {
      segments_.at(child).exported = std::move(pushed.exported);
    }
  }
  Tile tile = join_tiles(std::move(parts), tree_, id);
  SimplifyOptions options;
  options.cost = options_.cost;
  options.keep = vertices_to_keep(tile, id);
  options.stop = options_.stop;
  simplify_witnesses(tile, options);
  segment.records.assign(tile.records.begin() + static_cast<std::ptrdiff_t>(segment.foreign.size()),
                         tile.records.end());
  segment.dependencies = std::move(tile.dependencies);
  segment.dependency_end = std::move(tile.dependency_end);
  segments_.emplace(id, std::move(segment));
  return push_up(std::move(tile));
}

/// Depth-first: replays the chain over the leaves below, then saturates and hands the segment on.
std::vector<RecordBounds> HierarchyBuilder::tighten(const TileId& id,
                                                    std::vector<InnerSegment*>& chain,
                                                    const Tin& t0) {
  if (id.level == 0) {
    const SampleRange window = tree_.window(id);
    replay_over_leaf(chain, t0, start_leaf_(window), window);
    report("tightening", ++leaves_done_, tree_.leaves());
    return {};
  }
  InnerSegment segment = std::move(segments_.at(id));
  segments_.erase(id);
  chain.push_back(&segment);
  const std::vector<TileId> children = tree_.children(id);
  for (std::size_t i = 0; i < children.size(); ++i) {
    const std::vector<RecordBounds> bounds = tighten(children[i], chain, t0);
    std::copy(bounds.begin(), bounds.end(), segment.foreign.begin() + segment.child_begin[i]);
  }
  chain.pop_back();
  std::vector<RecordBounds> exported = saturate(segment);
  sink_(segment.records);
  return exported;
}

Tin HierarchyBuilder::run() {
  Tin t0 = build(tree_.root()).tile.tin;
  leaves_done_ = 0;
  if (tree_.root().level > 0) {
    std::vector<InnerSegment*> chain;
    (void)tighten(tree_.root(), chain, t0);
  }
  return t0;
}

}  // namespace ptin
