// SPDX-License-Identifier: GPL-3.0-or-later
//
// The orientation predicate, on 4096 seeded triples that stay in the cache: calls a second.
//   BM_Orient/points:p             ours: exact in 64-bit integers on the grid
//   BM_OrientRival/points:p        CGAL's filtered predicate (EPICK kernel) on the same triples as
//                                  doubles: what we would use without a grid
//   points:random is uniform on the whole grid; points:neighbours lies within 8 grid units, a
//   quarter of it collinear, as in rasters; points:collinear is exactly collinear and far apart,
//   where a filter fails.
// Cannot show: the cost inside a walk or a collapse, where memory and branches count for more.
#include <random>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <benchmark/benchmark.h>

#include "bench/support/counters.h"
#include "engine/geometry/orient.h"

namespace {

using namespace ptin;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct Triple {
  GridPoint a, b, c;
};

enum Kind { kRandom, kNeighbours, kCollinear };
constexpr const char* kKindNames[] = {"random", "neighbours", "collinear"};

std::vector<Triple> triples(Kind kind) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int32_t> anywhere(0, kGridMax), near(0, 8), step(1, 1 << 20);
  std::vector<Triple> result(4096);
  for (Triple& t : result) {
    const GridPoint base = {anywhere(random) / 2, anywhere(random) / 2};
    if (kind == kRandom) {
      t = {{anywhere(random), anywhere(random)},
           {anywhere(random), anywhere(random)},
           {anywhere(random), anywhere(random)}};
    } else if (kind == kNeighbours) {
      const auto beside = [&] { return GridPoint{base.x + near(random), base.y + near(random)}; };
      t = {beside(), beside(), beside()};
    } else {
      const std::int32_t dx = step(random), dy = step(random);
      t = {base, {base.x + 3 * dx, base.y + 3 * dy}, {base.x + 7 * dx, base.y + 7 * dy}};
    }
  }
  return result;
}

void BM_Orient(benchmark::State& state, Kind kind) {
  const std::vector<Triple> points = triples(kind);
  for (auto _ : state) {
    int left = 0;
    for (const Triple& t : points) left += orient(t.a, t.b, t.c) > 0 ? 1 : 0;
    benchmark::DoNotOptimize(left);
  }
  bench::add_rate(state, "orientations/s", points.size());
}

void BM_OrientRival(benchmark::State& state, Kind kind) {
  std::vector<Kernel::Point_2> points;
  for (const Triple& t : triples(kind)) {
    for (const GridPoint p : {t.a, t.b, t.c}) points.emplace_back(p.x, p.y);
  }
  for (auto _ : state) {
    int left = 0;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      left += CGAL::orientation(points[i], points[i + 1], points[i + 2]) == CGAL::LEFT_TURN ? 1 : 0;
    }
    benchmark::DoNotOptimize(left);
  }
  bench::add_rate(state, "orientations/s", points.size() / 3);
}

[[maybe_unused]] const bool registered = [] {
  for (const Kind kind : {kRandom, kNeighbours, kCollinear}) {
    const std::string points = std::string("/points:") + kKindNames[kind];
    benchmark::RegisterBenchmark(("BM_Orient" + points).c_str(), BM_Orient, kind);
    benchmark::RegisterBenchmark(("BM_OrientRival" + points).c_str(), BM_OrientRival, kind);
  }
  return true;
}();

}  // namespace
