// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refinement, warm: splits a second of processor time. The store is PTIN_BENCH_STORE or is built
// from srtm1_bigtujunga; without either, all is skipped.
//   BM_RefineWindow/area_ppm:n  one window of n millionths of the area, full detail, whole domain:
//                               search, read, apply
//   BM_Retrieve/area_ppm:n      the same, search and read alone
//   BM_Apply/area_ppm:n         the same, counting sort and splits alone
// Each begins with a round that does not count: the first touch of new memory, which on a virtual
// machine the host may have to find first.
// Cannot show: cold pages (ptin bench); several queries at once.
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/coarsest.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

Region window_of(const benchmark::State& state) {
  return window_at(facts(), static_cast<double>(state.range(0)));
}

void report(benchmark::State& state, std::uint64_t splits) {
  state.counters["splits"] = static_cast<double>(splits);
  add_rate(state, "splits/s", splits);
}

void BM_RefineWindow(benchmark::State& state) {
  if (skipped(state)) return;
  RefineRequest request;
  request.region = window_of(state);
  const std::uint64_t splits = terrain()->refine(request).cost.records_applied;
  for (auto _ : state) {
    const RefinedTin result = terrain()->refine(request);
    benchmark::DoNotOptimize(result.tin.triangles.data());
  }
  report(state, splits);
}

void BM_Retrieve(benchmark::State& state) {
  if (skipped(state)) return;
  const StoreFile& file = *store();
  const PredicatePtr window = meets_region(window_of(state), file.facts().map);
  const auto read = [&] {
    QueryContext context({.memory_bytes = UINT64_MAX}, "");
    return retrieve({file, file.index()}, *window, 0, context).size();
  };
  const std::uint64_t splits = read();
  for (auto _ : state) {
    benchmark::DoNotOptimize(read());
  }
  report(state, splits);
}

void BM_Apply(benchmark::State& state) {
  if (skipped(state)) return;
  const StoreFile& file = *store();
  const PredicatePtr window = meets_region(window_of(state), file.facts().map);
  QueryContext context({.memory_bytes = UINT64_MAX}, "");
  const std::vector<PendingSplit> splits = retrieve({file, file.index()}, *window, 0, context);
  const Tin t0 = mesh_of(file.t0(), "");
  const auto apply = [&] {
    Refinement refinement(t0);
    refinement.apply(splits, context);
    benchmark::DoNotOptimize(refinement.tin().triangles.data());
  };
  apply();
  for (auto _ : state) {
    apply();
  }
  report(state, splits.size());
}

#define PTIN_WINDOWS \
  ->ArgName("area_ppm")->Arg(1000)->Arg(40000)->Arg(250000)->Unit(benchmark::kMillisecond)
BENCHMARK(BM_RefineWindow) PTIN_WINDOWS;
BENCHMARK(BM_Retrieve) PTIN_WINDOWS;
BENCHMARK(BM_Apply) PTIN_WINDOWS;

}  // namespace
