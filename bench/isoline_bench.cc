// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines (paper, section 5.2). The store: PTIN_BENCH_STORE, else srtm1_bigtujunga.
//
// IsolineOne/T       the middle height of the whole terrain, T threads: levels a second of wall
//                    time, stars read per vertex of a crossing triangle
// IsolineTwenty/T    twenty levels at once
// IsolineBySplits/L  one level and twenty by splits, in one mesh: records retrieved per vertex of a
//                    crossing triangle
// ProgressiveSplit   the records of one level applied one by one, isolines kept up to date after
//                    each: splits a second, triangles looked at a split
#include <algorithm>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/isoline/isoline_progressive.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

/// Evenly between the lowest and the highest height.
std::vector<double> levels_between(int count) {
  const StoreFacts& f = facts();
  std::vector<double> levels;
  for (int i = 1; i <= count; ++i) {
    levels.push_back(f.min_height + (f.max_height - f.min_height) * i / (count + 1));
  }
  return levels;
}

void extract(benchmark::State& state, int levels, AnswerBy by, int threads) {
  if (skipped(state)) return;
  IsolineRequest request;
  request.levels = levels_between(levels);
  request.threads = threads;
  request.counts_vertices = true;
  QueryCost cost;
  TraceCounts crossed;
  for (auto _ : state) {
    const Isolines lines = terrain()->isolines(request, by);
    cost = lines.cost;
    crossed = lines.crossed;
  }
  const std::uint64_t vertices = std::max<std::uint64_t>(crossed.vertices, 1);
  if (by == AnswerBy::kStars) {
    add_mean(state, "stars/vertex", cost.stars_read, vertices);
  } else {
    add_mean(state, "records/vertex", cost.records_retrieved, vertices);
  }
  state.counters["segments"] = static_cast<double>(crossed.segments);
  add_rate(state, "segments/s", crossed.segments);
}

void IsolineOne(benchmark::State& state) {
  extract(state, 1, AnswerBy::kStars, static_cast<int>(state.range(0)));
}
BENCHMARK(IsolineOne)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void IsolineTwenty(benchmark::State& state) {
  extract(state, 20, AnswerBy::kStars, static_cast<int>(state.range(0)));
}
BENCHMARK(IsolineTwenty)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void IsolineBySplits(benchmark::State& state) {
  extract(state, static_cast<int>(state.range(0)), AnswerBy::kSplits, 1);
}
BENCHMARK(IsolineBySplits)->Arg(1)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime();

void ProgressiveSplit(benchmark::State& state) {
  if (skipped(state)) return;
  const LevelSet levels(levels_between(1), facts().heights);
  QueryContext context({.memory_bytes = ~0ULL}, store()->path());
  std::vector<PendingSplit> splits =
      retrieve({*store(), store()->index()}, *levels.crossing(), 0, context);
  std::sort(splits.begin(), splits.end(), is_before);
  IsolineChange all;
  for (auto _ : state) {
    state.PauseTiming();
    Refinement mesh(terrain()->t0());
    ProgressiveIsolines kept(mesh.tin(), levels, facts().heights, facts().map);
    all = {};
    state.ResumeTiming();
    for (const PendingSplit& split : splits) {
      mesh.apply({&split, 1}, context);
      all.triangles += kept.advance(mesh.tin()).triangles;
    }
  }
  add_rate(state, "splits/s", splits.size());
  add_mean(state, "triangles/split", all.triangles, splits.size());
}
BENCHMARK(ProgressiveSplit)->Unit(benchmark::kMillisecond);

}  // namespace
