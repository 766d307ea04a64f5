// SPDX-License-Identifier: GPL-3.0-or-later
//
// The moving window, warm, over the store of PTIN_BENCH_STORE (or srtm1_bigtujunga).
//   BM_Fresh/area_ppm:n               a fresh refinement of a window of n millionths of the area
//   BM_Move/area_ppm:n/step_ppm:s     that window moved by s millionths of its width, to and fro:
//                                     one move; `changed` counts splits made and undone
//   BM_FirstMove/area_ppm:n           a new window moved there: against BM_Fresh, what the bits
//                                     cost
//   BM_Eye/tau_ppm:t                  a view moved by a thousandth of the terrain's width
// Cannot show: cold pages; caches that do not hold the window's pages.
#include <memory>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/questions.h"
#include "engine/query/refine/moving_window.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

void BM_Fresh(benchmark::State& state) {
  if (skipped(state)) return;
  RefineRequest request;
  request.region = window_at(facts(), static_cast<double>(state.range(0)));
  std::uint64_t splits = 0;
  for (auto _ : state) {
    splits = terrain()->refine(request).cost.records_applied;
  }
  state.counters["splits"] = static_cast<double>(splits);
}

void BM_FirstMove(benchmark::State& state) {
  if (skipped(state)) return;
  const PredicatePtr p =
      meets_region(window_at(facts(), static_cast<double>(state.range(0))), facts().map);
  std::uint64_t splits = 0;
  for (auto _ : state) {
    MovingWindow window{OpenedTerrain(store())};
    splits = window.move_to(p).entered;
  }
  state.counters["splits"] = static_cast<double>(splits);
}

void move_among(benchmark::State& state, const std::vector<PredicatePtr>& places) {
  MovingWindow window{OpenedTerrain(store())};
  for (const PredicatePtr& p : places) {
    window.move_to(p);
  }
  std::uint64_t changed = 0, examined = 0, moves = 0;
  for (auto _ : state) {
    // To and fro: 0 1 2 ... n-1 ... 2 1 0 ...
    const std::size_t last = places.size() - 1;
    const std::size_t i = moves++ % (2 * last);
    const MoveResult moved = window.move_to(places[i < last ? last - 1 - i : i - last + 1]);
    changed += moved.entered + moved.left;
    examined += moved.cost.records_examined;
  }
  add_mean(state, "changed", changed, moves);
  add_mean(state, "examined", examined, moves);
}

void BM_Move(benchmark::State& state) {
  if (skipped(state)) return;
  std::vector<PredicatePtr> places;
  for (int i = 0; i < 16; ++i) {
    const double shift = i * static_cast<double>(state.range(1)) / 1e6;
    places.push_back(
        meets_region(window_at(facts(), static_cast<double>(state.range(0)), shift), facts().map));
  }
  move_among(state, places);
}

void BM_Eye(benchmark::State& state) {
  if (skipped(state)) return;
  const StoreFacts& f = facts();
  std::vector<PredicatePtr> places;
  for (int i = 0; i < 16; ++i) {
    View view;
    view.eye = f.map.to_map(f.bounds.min_x + (f.bounds.max_x - f.bounds.min_x) * (0.4 + i * 0.001),
                            0.5 * (f.bounds.min_y + f.bounds.max_y));
    view.tau = static_cast<double>(state.range(0)) / 1e6;
    places.push_back(seen_from(view, f.map, f.heights));
  }
  move_among(state, places);
}

#define PTIN_AREAS ->ArgName("area_ppm")->Arg(40000)->Arg(250000)->Unit(benchmark::kMicrosecond)
BENCHMARK(BM_Fresh) PTIN_AREAS;
BENCHMARK(BM_FirstMove) PTIN_AREAS;
BENCHMARK(BM_Move)
    ->ArgNames({"area_ppm", "step_ppm"})
    ->ArgsProduct({{40000, 250000}, {1000, 10000, 100000}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Eye)->ArgName("tau_ppm")->Arg(500)->Arg(5000)->Unit(benchmark::kMicrosecond);

}  // namespace
