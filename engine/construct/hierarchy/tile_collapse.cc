// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/tile_collapse.h"

#include <algorithm>
#include <utility>

#include "engine/construct/collapse/first_pass.h"
#include "engine/construct/collapse/simplify.h"
#include "engine/construct/tile/joined_surface.h"

namespace ptin {

namespace {

std::uint64_t vertices_to_keep(const Tile& tile, const TileTree& tree, const TileId& id) {
  if (id == tree.root()) {
    return 0;
  }
  const auto free = std::count_if(tile.vertex_state.begin(), tile.vertex_state.end(),
                                  [](const VertexState& v) { return !v.locked; });
  return static_cast<std::uint64_t>(free) / 4;
}

SimplifyOptions simplify_options(const CollapseOptions& options, std::uint64_t keep,
                                 const std::stop_token& stop) {
  SimplifyOptions result;
  result.cost = options.cost;
  result.keep = keep;
  result.stop = stop;
  return result;
}

}  // namespace

CollapsedLeaf collapse_leaf(const TileId& id, const TileTree& tree, const LeafStarter& start,
                            const CollapseOptions& options, const std::stop_token& stop) {
  StartedTile leaf = start(tree.window(id));
  lock_seams(leaf.tile, tree, id);
  const std::uint64_t keep = vertices_to_keep(leaf.tile, tree, id);  // before the first pass
  SimplifyOptions simplifying = simplify_options(options, keep, stop);
  if (leaf.tile.samples_fill_grid) {
    if (options.first_pass > 0.0) {
      run_first_pass(leaf.tile, *leaf.full, leaf.box, leaf.around, options.first_pass);
    } else {
      simplifying.full_raster = leaf.box;
    }
  }
  simplify(leaf.tile, *leaf.full, simplifying);
  CollapsedLeaf result;
  result.lone_samples = leaf.lone_samples;
  PushedTile pushed = push_up(std::move(leaf.tile), PushedSamples::kAll);
  result.records = starred_records(std::move(pushed.records), 0, std::move(pushed.stars));
  result.pushed = std::move(pushed.tile);
  result.full = std::move(leaf.full);
  result.box = leaf.box;
  return result;
}

CollapsedGroup collapse_group(const TileId& id, const TileTree& tree,
                              std::vector<CollapsedLeaf>&& leaves, const CollapseOptions& options,
                              const std::stop_token& stop) {
  JoinedSurface full;
  std::vector<Tile> parts;
  for (CollapsedLeaf& leaf : leaves) {
    full.add(std::move(leaf.full), leaf.box);
    parts.push_back(std::move(leaf.pushed));
  }
  Tile tile = join_tiles(std::move(parts), tree, id);
  const std::size_t foreign = tile.records.size();
  simplify(tile, full, simplify_options(options, vertices_to_keep(tile, tree, id), stop));
  CollapsedGroup result;
  PushedTile pushed = push_up(std::move(tile), PushedSamples::kCarried);
  result.records = starred_records(std::move(pushed.records), foreign, std::move(pushed.stars));
  result.pushed = std::move(pushed.tile);
  return result;
}

CollapsedInner collapse_inner(const TileId& id, const TileTree& tree, std::vector<Tile>&& parts,
                              const CollapseOptions& options, const std::stop_token& stop) {
  CollapsedInner result;
  InnerSegment& segment = result.segment;
  segment.id = id;
  for (const Tile& part : parts) {
    segment.child_begin.push_back(static_cast<std::uint32_t>(segment.foreign.size()));
    for (const VertexSplit& r : part.records) {
      segment.foreign.push_back({r.error, r.deviation});
    }
  }
  Tile tile = join_tiles(std::move(parts), tree, id);
  simplify_carried_samples(tile, simplify_options(options, vertices_to_keep(tile, tree, id), stop));
  PushedTile pushed = push_up(std::move(tile), PushedSamples::kCarried);
  pushed.records.erase(
      pushed.records.begin(),
      pushed.records.begin() + static_cast<std::ptrdiff_t>(segment.foreign.size()));
  segment.records = std::move(pushed.records);
  segment.stars = std::move(pushed.stars);
  segment.exported = std::move(pushed.exported);
  result.pushed = std::move(pushed.tile);
  return result;
}

}  // namespace ptin
