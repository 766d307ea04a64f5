// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/part_refiner.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"
#include "engine/stop.h"

namespace ptin {

namespace {

Detail detail_of(const PartRequest& request, const OpenedTerrain& terrain) {
  QueryContext context(request.limits, terrain.store().path());
  return Detail(request.detail, terrain.record_source(), context);
}

PredicatePtr wanted_by(const PartRequest& request, const Detail& detail, const StoreFacts& facts) {
  std::vector<PredicatePtr> parts = {std::make_shared<AboveError>(detail.tolerance())};
  if (request.region) parts.push_back(meets_region(*request.region, facts.map));
  if (request.also) parts.push_back(request.also);
  return all_of(std::move(parts));
}

std::uint64_t records_above(const StoreFile& store, double tolerance) {
  if (tolerance < 0) return store.record_count();
  std::uint64_t records = 0;
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.upper > tolerance) records += bin.records;
  }
  return records;
}

/// The walk over the quadtree of cells.
class Walk {
 public:
  using Visit = std::function<void(const GridCell&, RefinedTin&, double)>;
  Walk(const PartRefiner& refiner, const Visit& visit) : refiner_(refiner), visit_(visit) {
    const GridBox& b = refiner.terrain().store().facts().bounds;
    domain_ = b;
    area_ = area_in(b);
  }

  void run() {
    const auto differing = static_cast<std::uint32_t>(domain_.min_x ^ domain_.max_x) |
                           static_cast<std::uint32_t>(domain_.min_y ^ domain_.max_y);
    const int level = std::bit_width(differing);
    const auto x = static_cast<std::uint32_t>(domain_.min_x) >> level << level;
    const auto y = static_cast<std::uint32_t>(domain_.min_y) >> level << level;
    visit({x, y, level}, refiner_.records());
  }

 private:
  /// @param expected  Records of the cell if they were spread evenly.
  void visit(const GridCell& cell, std::uint64_t expected) {
    const GridBox box = cell.box();
    if (!meets(box, domain_)) return;
    stop_if_asked(refiner_.request().limits.stop, "the walk over the terrain",
                  refiner_.terrain().store().path());
    // A search of the index lists all pages: not worth it for cells that are far too large anyway.
    const bool is_hopeless =
        refinement_bytes(expected) / 16 > refiner_.request().limits.memory_bytes;
    if (cell.level > 0 && (is_hopeless || !refiner_.fits(box))) {
      for (const GridCell& child : children(cell)) visit(child, expected / 4);
      return;
    }
    RefinedTin refined = refiner_.refine(box);  // refuses what does not fit
    done_ += area_in(box);
    visit_(cell, refined, area_ > 0 ? std::min(1.0, done_ / area_) : 1.0);
  }

  [[nodiscard]] double area_in(const GridBox& box) const {
    const double width = std::min(box.max_x, domain_.max_x) - std::max(box.min_x, domain_.min_x);
    const double height = std::min(box.max_y, domain_.max_y) - std::max(box.min_y, domain_.min_y);
    return (width + 1.0) * (height + 1.0);
  }

  static std::array<GridCell, 4> children(const GridCell& cell) {
    const int level = cell.level - 1;
    const std::uint32_t side = 1U << level;
    std::array<GridCell, 4> cells = {{{cell.x, cell.y, level},
                                      {cell.x + side, cell.y, level},
                                      {cell.x, cell.y + side, level},
                                      {cell.x + side, cell.y + side, level}}};
    std::sort(cells.begin(), cells.end(), [](const GridCell& a, const GridCell& b) {
      return hilbert_position(a.x, a.y) < hilbert_position(b.x, b.y);
    });
    return cells;
  }

  const PartRefiner& refiner_;
  const Visit& visit_;
  GridBox domain_;
  double area_ = 0.0;
  double done_ = 0.0;
};

}  // namespace

PartRefiner::PartRefiner(const OpenedTerrain& terrain, PartRequest request)
    : terrain_(terrain),
      request_(std::move(request)),
      detail_(detail_of(request_, terrain)),
      wanted_(wanted_by(request_, detail_, terrain.store().facts())),
      t0_bytes_(bytes_of(terrain.t0())),
      records_(records_above(terrain.store(), detail_.tolerance())) {}

std::uint64_t PartRefiner::bytes_for(const GridBox& box) const {
  const StoreFile& store = terrain_.store();
  std::vector<PageId> pages;
  IoCounters counters;
  terrain_.index().search(*all_of({wanted_, std::make_shared<MeetsBox>(box)}), pages, counters);
  return t0_bytes_ + refinement_bytes(most_records(store, pages));
}

RefinedTin PartRefiner::refine(const GridBox& box) const {
  const auto start = std::chrono::steady_clock::now();
  const StoreFile& store = terrain_.store();
  QueryContext context(request_.limits, store.path());
  const PredicatePtr in_box = all_of({wanted_, std::make_shared<MeetsBox>(box)});
  std::vector<PendingSplit> splits =
      retrieve(terrain_.record_source(), *in_box, t0_bytes_, context);
  detail_.keep(splits);
  Refinement refinement(terrain_.t0());
  refinement.apply(splits, context);
  store.pages().check_unchanged();
  RefinedTin result;
  result.tin = refinement.release_tin();
  fill_in_facts(result, terrain_, detail_.certificate(), context, start);
  return result;
}

GridBox GridCell::box() const noexcept {
  const auto last = [this](std::uint32_t first) {
    const std::uint64_t end = std::uint64_t{first} + (std::uint64_t{1} << level) - 1;
    return static_cast<std::int32_t>(std::min<std::uint64_t>(end, kGridMax));
  };
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), last(x), last(y)};
}

void walk_cells(
    const PartRefiner& refiner,
    const std::function<void(const GridCell& cell, RefinedTin& refined, double done)>& visit) {
  Walk(refiner, visit).run();
}

}  // namespace ptin
