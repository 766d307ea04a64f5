// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest point of a window, on the store that PTIN_BENCH_STORE names (else one of
// srtm1_bigtujunga).
//   Highest/ppm:N  one random window of N millionths of the terrain, exact, warm: microseconds;
//                  pages, index nodes and records a window
//
// Windows are uniform and seeded. What this cannot show: a cold disk (ptin bench).
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/heights/highest.h"

namespace {

using namespace ptin;
using bench::skipped;
using bench::terrain;

std::vector<Window> random_windows(std::size_t count, double share) {
  const StoreFacts& f = terrain()->store().facts();
  const double side = std::sqrt(share);
  std::mt19937_64 random(1997);
  std::uniform_real_distribution<double> place(0.0, 1.0 - side);
  std::vector<Window> windows;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    const auto at = [&](double right, double up) {
      return f.map.to_map(f.bounds.min_x + right * (f.bounds.max_x - f.bounds.min_x),
                          f.bounds.min_y + up * (f.bounds.max_y - f.bounds.min_y));
    };
    const MapPoint low = at(x, y);
    const MapPoint high = at(x + side, y + side);
    windows.push_back({low.x, low.y, high.x, high.y});
  }
  return windows;
}

void Highest(benchmark::State& state) {
  if (skipped(state)) return;
  const std::vector<Window> windows =
      random_windows(200, static_cast<double>(state.range(0)) * 1e-6);
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
    cost.records_applied += result.cost.records_applied;
    cost.io.pages += result.cost.io.pages;
    cost.io.index_nodes += result.cost.io.index_nodes;
  }
  const auto each = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(asked);
  };
  state.counters["records"] = each(cost.records_applied);
  state.counters["pages"] = each(cost.io.pages);
  state.counters["nodes"] = each(cost.io.index_nodes);
}
BENCHMARK(Highest)->ArgName("ppm")->Arg(1000)->Arg(40000)->Unit(benchmark::kMicrosecond);

}  // namespace
