// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opening a store, warm. The store is PTIN_BENCH_STORE or is built from srtm1_bigtujunga; without
// either, all is skipped.
//   BM_Open/access:a           open and close: header, tables, metadata, T0, root of the index
//   BM_OpenAndPoint/access:a   open, refine to the full triangle over one of 2500 regular places,
//                              close
//   BM_Point/access:a          the same on a store that stays open
// Counters: records and pages a point, worst_us the slowest single call. Times are of the clock.
// Cannot show: cold pages (ptin bench), other sizes (give PTIN_BENCH_STORE), the walk to the
// triangle.
#include <algorithm>
#include <chrono>
#include <string>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

constexpr int kPlaces = 50;

MapPoint place(const StoreFacts& f, int i) {
  const auto at = [](std::int32_t low, std::int32_t high, int k) {
    return low + (double(high) - low) * (k + 0.5) / kPlaces;
  };
  return f.map.to_map(at(f.bounds.min_x, f.bounds.max_x, i % kPlaces),
                      at(f.bounds.min_y, f.bounds.max_y, i / kPlaces));
}

struct Sums {
  double calls = 0, records = 0, pages = 0, worst_us = 0;
};

void ask(const Terrain& tin, int i, Sums& sums) {
  RefineRequest request;
  request.region = place(tin.store().facts(), i);
  const RefinedTin answer = tin.refine(request);
  benchmark::DoNotOptimize(answer.triangles);
  sums.records += double(answer.cost.records_applied);
  sums.pages += double(answer.cost.io.pages);
}

void report(benchmark::State& state, const Sums& sums) {
  add_mean(state, "records", sums.records, sums.calls);
  add_mean(state, "pages", sums.pages, sums.calls);
  state.counters["worst_us"] = sums.worst_us;
}

void BM_Open(benchmark::State& state, PageAccess access) {
  if (skipped(state)) return;
  for (auto _ : state) {
    const Terrain tin = Terrain::open(bench_store(), access);
    benchmark::DoNotOptimize(tin.store().record_count());
  }
}

/// A point each time; `stays_open` decides what is timed.
void BM_Points(benchmark::State& state, PageAccess access, bool stays_open) {
  if (skipped(state)) return;
  const Terrain kept = Terrain::open(bench_store(), access);
  Sums sums;
  int next = 0;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    next = (next + 1237) % (kPlaces * kPlaces);  // coprime: comes past all places, far apart
    if (stays_open) {
      ask(kept, next, sums);
    } else {
      ask(Terrain::open(bench_store(), access), next, sums);
    }
    const std::chrono::duration<double, std::micro> spent =
        std::chrono::steady_clock::now() - begin;
    sums.worst_us = std::max(sums.worst_us, spent.count());
    ++sums.calls;
  }
  report(state, sums);
}

[[maybe_unused]] const bool registered = [] {
  for (const auto& [access, name] :
       {std::pair(PageAccess::kMapped, "mapped"), std::pair(PageAccess::kPread, "pread")}) {
    const std::string suffix = std::string("/access:") + name + "/cache:warm";
    const auto add = [&](const std::string& title, auto function, auto... arguments) {
      benchmark::RegisterBenchmark((title + suffix).c_str(), function, arguments...)
          ->Unit(benchmark::kMicrosecond)
          ->UseRealTime();
    };
    add("BM_Open", BM_Open, access);
    add("BM_OpenAndPoint", BM_Points, access, false);
    add("BM_Point", BM_Points, access, true);
  }
  return true;
}();

}  // namespace
