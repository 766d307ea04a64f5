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
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/heights/locate.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

void locate_one(benchmark::State& state, const LocateRequest& request) {
  if (skipped(state)) return;
  const std::vector<MapPoint> points = random_points(facts(), 1000);
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
  add_mean(state, "records", cost.records_examined, asked);
  add_mean(state, "stars", cost.stars_read, asked);
  add_mean(state, "pages", cost.io.pages, asked);
  add_mean(state, "nodes", cost.io.index_nodes, asked);
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
  const std::vector<MapPoint> points =
      random_points(facts(), static_cast<std::size_t>(state.range(0)));
  std::uint64_t applied = 0;
  for (auto _ : state) {
    const LocateResult result = locate(*terrain(), points);
    benchmark::DoNotOptimize(result.points.data());
    applied = result.cost.records_applied;
  }
  add_rate(state, "points/s", points.size());
  add_mean(state, "records/point", applied, points.size());
}
BENCHMARK(LocateBatch)->Arg(1000)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
