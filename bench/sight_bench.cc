// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight (paper, section 5.3). The store: PTIN_BENCH_STORE, else srtm1_bigtujunga.
//
// SightVerdict     random pairs over the whole terrain, ends 2 units above ground, exact verdict, one
//                  solver: pairs a second, the share hidden, stars and pages read a pair
// SightFull        the same with first obstruction and smallest clearance
// SightSingle...   the same pairs, each by itself, by stars and by splits: stars or records of a pair
//                  over the records that refining along the whole segment applies (`of_refining`)
//
// Pairs are uniform over the domain, and seeded. Distances are plane in map units, so in a
// geographic CRS the Earth's curvature plays no part here.
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/sight/sight.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

std::vector<SightPair> random_pairs(std::size_t count) {
  const std::vector<MapPoint> ends = random_points(facts(), 2 * count);
  std::vector<SightPair> pairs(count);
  for (std::size_t i = 0; i < count; ++i) pairs[i] = {ends[2 * i], 2.0, ends[2 * i + 1], 2.0};
  return pairs;
}

void solve_pairs(benchmark::State& state, bool verdict_only) {
  if (skipped(state)) return;
  const std::vector<SightPair> pairs = random_pairs(static_cast<std::size_t>(state.range(0)));
  SightRequest request;
  request.verdict_only = verdict_only;
  std::uint64_t hidden = 0;
  QueryCost cost;
  for (auto _ : state) {
    hidden = 0;
    cost = {};
    SightSolver solver(*terrain(), request);
    for (const SightPair& pair : pairs) {
      const SightResult r = solver.solve(pair);
      hidden += r.verdict == SightVerdict::kHidden ? 1 : 0;
      cost.add_counts(r.cost);
    }
  }
  add_rate(state, "pairs/s", pairs.size());
  add_mean(state, "hidden", hidden, pairs.size());
  add_mean(state, "stars/pair", cost.stars_read, pairs.size());
  add_mean(state, "pages/pair", cost.io.pages, pairs.size());
}

void SightVerdict(benchmark::State& state) { solve_pairs(state, true); }
BENCHMARK(SightVerdict)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);

void SightFull(benchmark::State& state) { solve_pairs(state, false); }
BENCHMARK(SightFull)->Arg(500)->Unit(benchmark::kMillisecond);

void single_pairs(benchmark::State& state, bool verdict_only, AnswerBy by) {
  if (skipped(state)) return;
  const std::vector<SightPair> pairs = random_pairs(200);
  SightRequest request;
  request.verdict_only = verdict_only;
  std::uint64_t used = 0;
  for (auto _ : state) {
    used = 0;
    for (const SightPair& pair : pairs) {
      const QueryCost cost = terrain()->sight(pair, request, by).cost;
      used += by == AnswerBy::kStars ? cost.stars_read : cost.records_applied;
    }
  }
  std::uint64_t refined = 0;
  for (const SightPair& pair : pairs) {
    RefineRequest along;
    along.region = Segment{pair.a, pair.b};
    refined += terrain()->refine(along).cost.records_applied;
  }
  add_rate(state, "pairs/s", pairs.size());
  add_mean(state, "used/pair", used, pairs.size());
  add_mean(state, "of_refining", used, refined);
}

BENCHMARK_CAPTURE(single_pairs, SightSingleVerdict, true, AnswerBy::kStars)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(single_pairs, SightSingleFull, false, AnswerBy::kStars)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(single_pairs, SightSingleVerdictBySplits, true, AnswerBy::kSplits)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(single_pairs, SightSingleFullBySplits, false, AnswerBy::kSplits)
    ->Unit(benchmark::kMillisecond);

}  // namespace
