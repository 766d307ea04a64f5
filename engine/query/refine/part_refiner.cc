// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/part_refiner.h"

#include <chrono>
#include <utility>
#include <vector>

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

void walk_cells(
    const PartRefiner& refiner,
    const std::function<void(const GridCell& cell, RefinedTin& refined, double done)>& visit) {
  const QueryLimits& limits = refiner.request().limits;
  const StoreFile& store = refiner.terrain().store();
  const auto fits = [&](const GridCell& cell, double share) {
    stop_if_asked(limits.stop, "the walk over the terrain", store.path());
    // A search of the index lists all pages: not worth it for cells that are far too large anyway.
    const auto expected =
        static_cast<std::uint64_t>(static_cast<double>(refiner.records()) * share);
    const bool is_hopeless = refinement_bytes(expected) / 16 > limits.memory_bytes;
    return !is_hopeless && refiner.fits(cell.box());
  };
  walk_fitting_cells(store.facts().bounds, fits, [&](const GridCell& cell, double done) {
    RefinedTin refined = refiner.refine(cell.box());  // refuses what does not fit
    visit(cell, refined, done);
  });
}

}  // namespace ptin
