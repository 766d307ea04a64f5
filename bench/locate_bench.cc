// SPDX-License-Identifier: GPL-3.0-or-later
//
// Point location (paper, section 5.1). The store: PTIN_BENCH_STORE, else srtm1_bigtujunga.
//
// LocateOne          one random point, exact, warm, a query of its own: microseconds; pages, index
//                    nodes, records of these pages and stars decoded a point
// LocateOneAtError   the same at a tolerance of 5 height units, with its interval
// LocateBatch/N      N random points over the whole terrain in one call, exact: points a second
//
// Points are uniform over the domain, and seeded. What this cannot show: a cold disk (ptin bench),
// points that lie as people's do, in clusters.
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/heights/locate.h"

namespace {

using namespace ptin;
using bench::skipped;
using bench::terrain;

std::vector<MapPoint> random_points(std::size_t count) {
  const StoreFacts& f = terrain()->store().facts();
  std::mt19937_64 random(1997);
  std::uniform_real_distribution<double> x(f.bounds.min_x, f.bounds.max_x);
  std::uniform_real_distribution<double> y(f.bounds.min_y, f.bounds.max_y);
  std::vector<MapPoint> points(count);
  for (MapPoint& p : points) p = f.map.to_map(x(random), y(random));
  return points;
}

void locate_one(benchmark::State& state, const LocateRequest& request) {
  if (skipped(state)) return;
  const std::vector<MapPoint> points = random_points(1000);
  QueryCost cost;
  std::size_t i = 0;
  std::size_t asked = 0;
  for (const MapPoint& p : points) static_cast<void>(locate(*terrain(), {&p, 1}, request));  // warm
  for (auto _ : state) {
    const LocateResult result = locate(*terrain(), {&points[i], 1}, request);
    benchmark::DoNotOptimize(result.points.data());
    i = i + 1 == points.size() ? 0 : i + 1;
    ++asked;
    cost.add_counts(result.cost);
  }
  const auto each = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(asked);
  };
  state.counters["records"] = each(cost.records_examined);
  state.counters["stars"] = each(cost.stars_read);
  state.counters["pages"] = each(cost.io.pages);
  state.counters["nodes"] = each(cost.io.index_nodes);
}

void LocateOne(benchmark::State& state) { locate_one(state, {}); }
BENCHMARK(LocateOne)->Unit(benchmark::kMicrosecond);

void LocateOneAtError(benchmark::State& state) {
  LocateRequest request;
  request.detail.tolerance = 5.0;
  locate_one(state, request);
}
BENCHMARK(LocateOneAtError)->Unit(benchmark::kMicrosecond);

void LocateBatch(benchmark::State& state) {
  if (skipped(state)) return;
  const std::vector<MapPoint> points = random_points(static_cast<std::size_t>(state.range(0)));
  std::uint64_t applied = 0;
  for (auto _ : state) {
    const LocateResult result = locate(*terrain(), points);
    benchmark::DoNotOptimize(result.points.data());
    applied = result.cost.records_applied;
  }
  state.counters["points/s"] = benchmark::Counter(static_cast<double>(points.size()),
                                                  benchmark::Counter::kIsIterationInvariantRate);
  state.counters["records/point"] =
      static_cast<double>(applied) / static_cast<double>(points.size());
}
BENCHMARK(LocateBatch)->Arg(1000)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
