// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest point of a window, on the store that PTIN_BENCH_STORE names (else one of
// srtm1_bigtujunga).
//   Highest/ppm:N  one random window of N millionths of the terrain, exact, warm: microseconds;
//                  pages, index nodes and records a window
//
// Windows are uniform and seeded. What this cannot show: a cold disk (ptin bench).
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/heights/highest.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

void Highest(benchmark::State& state) {
  if (skipped(state)) return;
  const std::vector<Window> windows =
      random_windows(facts(), 200, static_cast<double>(state.range(0)), 1997);
  HighestRequest request;
  for (const Window& w : windows) {  // warm
    request.region = w;
    static_cast<void>(highest(*terrain(), request));
  }
  QueryCost cost;
  std::size_t asked = 0;
  for (auto _ : state) {
    request.region = windows[asked++ % windows.size()];
    const HighestResult result = highest(*terrain(), request);
    benchmark::DoNotOptimize(result.point.height);
    cost.add_counts(result.cost);
  }
  add_mean(state, "records", cost.records_applied, asked);
  add_mean(state, "pages", cost.io.pages, asked);
  add_mean(state, "nodes", cost.io.index_nodes, asked);
}
BENCHMARK(Highest)->ArgName("ppm")->Arg(1000)->Arg(40000)->Unit(benchmark::kMicrosecond);

}  // namespace
