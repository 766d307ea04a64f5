// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/selective_refinement.h"

#include <algorithm>

#include "engine/geometry/infinity.h"

namespace ptin::paper {

namespace {

constexpr std::uint32_t kRankOfT0 = std::uint32_t{1} << 16;  // above every record's

}  // namespace

SelectiveRefinement::SelectiveRefinement(const OpenedTerrain& terrain, const Detail& detail)
    : terrain_(terrain), detail_(detail), refinement_(terrain.t0()) {
  made_.assign(tin().vertices.size(), {0, 0, 0.0F, kRankOfT0});
}

std::vector<PageId> SelectiveRefinement::search(const AttributePredicate& predicate,
                                                QueryContext& context) const {
  std::vector<PageId> pages;
  terrain_.index().search(predicate, pages, context.cost.io);
  context.check_stop();
  return pages;
}

std::uint64_t SelectiveRefinement::bytes_with(std::span<const PageId> pages) const {
  const std::uint64_t most = most_records(terrain_.store(), pages);
  // `made_` grows by half, and the old array stays beside the new one while it is copied. The
  // records that enter are held once in `entering_` and once in `made_`.
  const std::uint64_t made = made_.size() * 5 / 2 + 2 * most;
  return bytes_of(tin()) + refinement_bytes(most) + made * sizeof(Made);
}

std::size_t SelectiveRefinement::refine(std::span<const PageId> pages,
                                        const AttributePredicate& predicate, QueryContext& context,
                                        const AttributePredicate* beyond) {
  const StoreFile& store = terrain_.store();
  context.admit(bytes_with(pages));
  store.announce(pages, context.heights(), context.cost.io);
  splits_.clear();
  entering_.clear();
  const std::uint64_t most = most_records(store, pages);
  splits_.reserve(most);  // as much as was admitted: growing would take twice that
  entering_.reserve(most);
  for (const PageId page : pages) {
    context.check_stop();
    records_.clear();
    context.cost.records_examined +=
        store.read_matching(page, predicate, records_, context.heights(), context.cost.io);
    context.cost.records_retrieved += records_.size();
    for (const VertexSplit& r : records_) {
      const PendingSplit split = pending_of(r, page);
      const bool is_wanted =
          detail_.keeps(split) ||
          (beyond != nullptr && beyond->holds(attributes_of(r, store.facts().heights)));
      if (is_wanted && refinement_.find(split.u) == kNone) {
        splits_.push_back(split);
        entering_.push_back({r.height_lo, r.height_hi, r.deviation, r.rank});
      }
    }
  }
  refinement_.apply(splits_, context);  // sorts them topologically (engine/DESIGN.md, section 6.2)
  if (made_.capacity() < made_.size() + splits_.size()) {
    made_.reserve(made_.size() + std::max(splits_.size(), made_.size() / 2));
  }
  for (const std::uint32_t i : refinement_.applied_order()) {
    made_.push_back(entering_[i]);
  }
  return splits_.size();
}

SurfaceBounds SelectiveRefinement::bounds(TriangleId t) const noexcept {
  const auto& v = tin().triangles[t].v;
  const Made& made = *std::min({&made_[v[0]], &made_[v[1]], &made_[v[2]]},
                               [](const Made* a, const Made* b) { return a->rank < b->rank; });
  if (made.rank == kRankOfT0) {
    return {kInfinity, {-kInfinity, kInfinity}};
  }
  const HeightEncoding& heights = terrain_.store().facts().heights;
  return {made.deviation, {heights.code(made.lowest), heights.code(made.highest)}};
}

std::uint64_t SelectiveRefinement::bytes() const noexcept {
  return bytes_of(tin()) + (made_.capacity() + entering_.capacity()) * sizeof(Made) +
         records_.capacity() * sizeof(VertexSplit) + splits_.capacity() * sizeof(PendingSplit) +
         refinement_.applied_order().size() * sizeof(std::uint32_t);
}

void SelectiveRefinement::release_records() noexcept {
  // Assigning {} would keep the memory.
  std::vector<Made>().swap(entering_);
  std::vector<VertexSplit>().swap(records_);
  std::vector<PendingSplit>().swap(splits_);
}

}  // namespace ptin::paper
