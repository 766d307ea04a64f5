// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/tile_mesh.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace ptin {

namespace {

/// What a BoundedMesh keeps of a vertex and of a record that enters, by its own account of memory.
constexpr std::uint64_t kBoundsBytes = 24 * 5;

}  // namespace

TileMesh::TileMesh(const OpenedTerrain& terrain, const Detail& detail, PredicatePtr region)
    : terrain_(terrain), detail_(detail), facts_(terrain.store().facts()) {
  wanted_ = std::make_shared<AboveError>(detail.tolerance());
  if (region) wanted_ = all_of({wanted_, std::move(region)});
}

std::uint64_t TileMesh::announce(const GridBox& tile, QueryContext& context) {
  in_tile_ = all_of({std::make_shared<MeetsBox>(tile), wanted_});
  pages_.clear();
  terrain_.index().search(*in_tile_, pages_, context.cost.io);
  const std::uint64_t records = most_records(terrain_.store(), pages_);
  most_triangles_ = terrain_.t0().triangles.size() + 2 * records;
  const std::uint64_t bounds = is_exact() ? 0 : kBoundsBytes * records;
  return bytes_of(terrain_.t0()) + refinement_bytes(records) + bounds;
}

void TileMesh::refine(QueryContext& context) {
  if (!is_exact()) {
    bounded_.emplace(terrain_, detail_);
    bounded_->refine(pages_, *in_tile_, context);
    return;
  }
  splits_.clear();
  read_pages(terrain_.store(), pages_, *in_tile_, context, splits_);
  if (mesh_) {
    mesh_->restart(terrain_.t0());
  } else {
    mesh_.emplace(terrain_.t0());
  }
  mesh_->apply(splits_, context);
}

double TileMesh::deviation(TriangleId t) const noexcept {
  if (!bounded_) return 0.0;
  const Interval all = source_heights(facts_);
  const double certified = std::min(bounded_->bounds(t).deviation, detail_.certificate().deviation);
  return std::min(std::max(certified, facts_.base_deviation), std::max(all.hi - all.lo, 0.0));
}

Interval TileMesh::heights(TriangleId t) const noexcept {
  const Interval all = source_heights(facts_);
  if (!bounded_) return all;
  const Interval codes = bounded_->bounds(t).heights;
  if (codes.lo > codes.hi) return {1, 0};
  const double base = facts_.base_deviation;
  return {std::max(all.lo, facts_.heights.height_of_code(codes.lo) - base),
          std::min(all.hi, facts_.heights.height_of_code(codes.hi) + base)};
}

Interval source_heights(const StoreFacts& facts) noexcept {
  if (facts.min_height > facts.max_height) return {1, 0};
  return {facts.min_height - facts.base_deviation, facts.max_height + facts.base_deviation};
}

}  // namespace ptin
