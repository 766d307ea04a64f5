// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/selective_refinement.h"

#include <algorithm>
#include <limits>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

constexpr std::uint32_t kRankOfT0 = std::uint32_t{1} << 16;  // above every record's

}  // namespace

BoundedMesh::BoundedMesh(const OpenedTerrain& terrain, const Detail& detail)
    : terrain_(terrain), detail_(detail), refinement_(terrain.t0()) {
  const Made t0{-kInfinity, kInfinity, std::numeric_limits<float>::infinity(), kRankOfT0};
  made_.assign(tin().vertices.size(), t0);
}

std::vector<PageId> BoundedMesh::search(const AttributePredicate& predicate,
                                        QueryContext& context) const {
  std::vector<PageId> pages;
  terrain_.index().search(predicate, pages, context.cost.io);
  context.check_stop();
  return pages;
}

std::size_t BoundedMesh::refine(const AttributePredicate& predicate, QueryContext& context,
                                const AttributePredicate* beyond) {
  return refine(search(predicate, context), predicate, context, beyond);
}

std::size_t BoundedMesh::refine(std::span<const PageId> pages, const AttributePredicate& predicate,
                                QueryContext& context, const AttributePredicate* beyond) {
  const StoreFile& store = terrain_.store();
  const HeightEncoding& heights = store.facts().heights;
  const std::uint64_t most = most_records(store, pages);
  // `made_` grows by half, and the old array stays beside the new one while it is copied. The
  // records that enter are held once in `entering_` and once in `made_`.
  const std::uint64_t made = made_.size() * 5 / 2 + 2 * most;
  context.admit(bytes_of(tin()) + refinement_bytes(most) + made * sizeof(Made));
  store.pages().announce(pages, context.cost.io);
  splits_.clear();
  entering_.clear();
  splits_.reserve(most);  // as much as was admitted: growing would take twice that
  entering_.reserve(most);
  for (const PageId page : pages) {
    context.check_stop();
    records_.clear();
    context.cost.records_examined +=
        store.read_matching(page, predicate, records_, context.cost.io);
    context.cost.records_retrieved += records_.size();
    for (const VertexSplit& r : records_) {
      const PendingSplit split = pending_of(r, page);
      const bool is_wanted =
          detail_.keeps(split) || (beyond != nullptr && beyond->holds(attributes_of(r, heights)));
      if (!is_wanted || refinement_.find(split.u) != kNone) {
        continue;
      }
      splits_.push_back(split);
      entering_.push_back(
          {heights.code(r.height_lo), heights.code(r.height_hi), r.deviation, r.rank});
    }
  }
  refinement_.apply(splits_, context);
  if (made_.capacity() < made_.size() + splits_.size()) {
    made_.reserve(made_.size() + std::max(splits_.size(), made_.size() / 2));
  }
  for (const std::uint32_t i : refinement_.applied_order()) {
    made_.push_back(entering_[i]);
  }
  return splits_.size();
}

std::uint64_t BoundedMesh::bytes() const noexcept {
  return bytes_of(tin()) + (made_.capacity() + entering_.capacity()) * sizeof(Made) +
         records_.capacity() * sizeof(VertexSplit) + splits_.capacity() * sizeof(PendingSplit) +
         refinement_.applied_order().size() * sizeof(std::uint32_t);
}

void BoundedMesh::release_records() noexcept {
  // Assigning {} would keep the memory.
  std::vector<Made>().swap(entering_);
  std::vector<VertexSplit>().swap(records_);
  std::vector<PendingSplit>().swap(splits_);
}

SurfaceBounds BoundedMesh::bounds(TriangleId t) const noexcept {
  const Triangle& triangle = tin().triangles[t];
  const Made* made = &made_[triangle.v[0]];
  for (int i = 1; i < 3; ++i) {
    const Made& other = made_[triangle.v[i]];
    made = other.rank < made->rank ? &other : made;
  }
  return {made->deviation, {made->lowest, made->highest}};
}

}  // namespace ptin
