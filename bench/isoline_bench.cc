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

#include "bench/support/scratch.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/isoline/isoline_progressive.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace {

using namespace ptin;

const Terrain* terrain() {
  static const std::string path = bench::bench_store();
  if (path.empty()) return nullptr;
  static const Terrain opened = Terrain::open(path);
  return &opened;
}

bool skipped(benchmark::State& state) {
  if (terrain() != nullptr) return false;
  state.SkipWithError("no store: set PTIN_BENCH_STORE");
  return true;
}

/// Evenly between the lowest and the highest height.
std::vector<double> levels_between(int count) {
  const StoreFacts& f = terrain()->store().facts();
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
  request.by = by;
  request.counts_vertices = true;
  QueryCost cost;
  TraceCounts crossed;
  for (auto _ : state) {
    const Isolines lines = isolines(*terrain(), request);
    cost = lines.cost;
    crossed = lines.crossed;
  }
  const auto a_vertex = [&](std::uint64_t count) {
    return static_cast<double>(count) /
           static_cast<double>(std::max<std::uint64_t>(crossed.vertices, 1));
  };
  if (by == AnswerBy::kStars) {
    state.counters["stars/vertex"] = a_vertex(cost.stars_read);
  } else {
    state.counters["records/vertex"] = a_vertex(cost.records_retrieved);
  }
  const auto segments = static_cast<double>(crossed.segments);
  state.counters["segments"] = segments;
  state.counters["segments/s"] =
      benchmark::Counter(segments, benchmark::Counter::kIsIterationInvariantRate);
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
  const StoreFacts& facts = terrain()->store().facts();
  const LevelSet levels(levels_between(1), facts.heights);
  QueryContext context({.memory_bytes = ~0ULL}, terrain()->store().path());
  std::vector<PendingSplit> splits =
      retrieve({terrain()->store(), terrain()->index()}, *levels.crossing(), 0, context);
  std::sort(splits.begin(), splits.end(), is_before);
  IsolineChange all;
  for (auto _ : state) {
    state.PauseTiming();
    Refinement mesh(terrain()->t0());
    ProgressiveIsolines kept(mesh.tin(), levels, facts.heights, facts.map);
    all = {};
    state.ResumeTiming();
    for (const PendingSplit& split : splits) {
      mesh.apply({&split, 1}, context);
      all.triangles += kept.advance(mesh.tin()).triangles;
    }
  }
  const auto count = static_cast<double>(splits.size());
  state.counters["splits/s"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["triangles/split"] = static_cast<double>(all.triangles) / count;
}
BENCHMARK(ProgressiveSplit)->Unit(benchmark::kMillisecond);

}  // namespace
