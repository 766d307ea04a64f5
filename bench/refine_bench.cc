// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refinement, warm: splits a second of processor time. The store is the one that PTIN_BENCH_STORE
// names, as `ptin build` made it; otherwise it is made here by collapsing a synthetic raster in
// passes of independent vertices, in a random order, so ranks are low and the file's locality is
// worse than a builder's.
//   BM_RefineWindow/area_ppm:n  one window of n millionths of the area, full detail, whole domain:
//                               search, read, apply
//   BM_Retrieve/area_ppm:n      the same, search and read alone
//   BM_Apply/area_ppm:n         the same, counting sort and splits alone
// Cannot show: cold pages (bench/io); several queries at once.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "engine/mesh/collapse.h"
#include "engine/mesh/star.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/coarsest.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/terrain.h"
#include "storage/store_writer.h"

namespace {

using namespace ptin;

constexpr int kSide = 2048;

CoarsestTin raster() {
  CoarsestTin t;
  const HeightEncoding heights;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      t.vertices.push_back(
          {{x, y}, heights.bits(std::round(100 * std::sin(x * 0.01) * std::cos(y * 0.013))), 1});
    }
  }
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const auto a = static_cast<std::uint32_t>(y * kSide + x);
      t.triangles.push_back({{a, a + 1, a + kSide + 1}, 0});
      t.triangles.push_back({{a, a + kSide + 1, a + kSide}, 0});
    }
  }
  return t;
}

Tin grid_mesh() {
  const CoarsestTin t = raster();
  Tin tin;
  for (const auto& v : t.vertices) {
    tin.vertices.push_back({v.position, v.height, kNone});
  }
  tin.has_height.assign(tin.vertices.size(), 1);
  tin.classes.assign(t.triangles.size(), TriangleClass::kSurface);
  const int cells = kSide - 1;
  const auto id = [&](int x, int y, int upper) {
    return x < 0 || y < 0 || x >= cells || y >= cells
               ? kNone
               : static_cast<TriangleId>(2 * (y * cells + x) + upper);
  };
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const auto& lower = t.triangles[id(x, y, 0)];
      const auto& upper = t.triangles[id(x, y, 1)];
      tin.triangles.push_back(
          {{lower.v[0], lower.v[1], lower.v[2]}, {id(x + 1, y, 1), id(x, y, 1), id(x, y - 1, 1)}});
      tin.triangles.push_back(
          {{upper.v[0], upper.v[1], upper.v[2]}, {id(x, y + 1, 0), id(x - 1, y, 0), id(x, y, 0)}});
    }
  }
  tin.triangles.shrink_to_fit();
  for (TriangleId t2 = 0; t2 < tin.triangles.size(); ++t2) {
    const Triangle& triangle = tin.triangles[t2];
    for (int c = 0; c < 3; ++c) {
      TriangleId& slot = tin.vertices[triangle.v[c]].triangle;
      if (slot == kNone || triangle.n[previous_corner(c)] == kNone) {
        slot = t2;
      }
    }
  }
  return tin;
}

struct Carried {
  GridBox roi;
  float error = 0;
  int rank = -1;
};

class Passes {
 public:
  Passes() : tin_(grid_mesh()), carried_(tin_.triangles.size()), last_(tin_.vertices.size(), -1) {}
  std::vector<VertexSplit> run() {
    std::mt19937_64 random(1);
    std::vector<VertexId> order(tin_.vertices.size());
    for (VertexId v = 0; v < order.size(); ++v) order[v] = v;
    for (pass_ = 0; pass_ < 60 && order.size() > 4; ++pass_) {
      std::shuffle(order.begin(), order.end(), random);
      for (const VertexId v : order) collapse_one(v);
      std::erase_if(order, [&](VertexId v) { return tin_.vertices[v].triangle == kNone; });
    }
    return std::move(records_);
  }
  const Tin& tin() const { return tin_; }

 private:
  void collapse_one(VertexId u) {
    if (last_[u] == pass_) return;
    walk_star(tin_, u, star_);
    if (star_.degree() > 12) return;
    std::size_t best = star_.degree();
    std::int64_t least = INT64_MAX;
    for (std::size_t j = 0; j < star_.degree(); ++j) {
      const GridPoint a = tin_.position(u), b = tin_.position(star_.link[j]);
      const std::int64_t d =
          std::int64_t{a.x - b.x} * (a.x - b.x) + std::int64_t{a.y - b.y} * (a.y - b.y);
      if (d < least && can_collapse(tin_, star_, j)) least = d, best = j;
    }
    if (best == star_.degree()) return;
    Carried own;
    own.roi = box_of(tin_.position(u));
    for (const VertexId v : star_.link)
      own.roi = united(own.roi, tin_.position(v)), last_[v] = pass_;
    for (const TriangleId t : star_.triangles) {
      own.roi = united(own.roi, carried_[t].roi);
      own.error = std::max(own.error, carried_[t].error);
      own.rank = std::max(own.rank, carried_[t].rank);
    }
    ++own.rank;
    own.error = std::max(own.error, std::ldexp(1.0F, pass_ / 4));
    const CollapseSite s = collapse_site(star_, best);
    VertexSplit r;
    r.u = tin_.position(s.u), r.w = tin_.position(s.w), r.vl = tin_.position(s.vl),
    r.vr = tin_.position(s.vr);
    r.height = tin_.vertices[s.u].height;
    r.roi = own.roi;
    r.height_lo = HeightEncoding{}.bits(-100), r.height_hi = HeightEncoding{}.bits(100);
    r.error = r.deviation = own.error;
    r.rank = static_cast<std::uint16_t>(own.rank);
    if (s.left == kNone) r.flags |= VertexSplit::kNoLeft;
    if (s.right == kNone) r.flags |= VertexSplit::kNoRight;
    records_.push_back(r);
    collapse(tin_, star_, best);
    for (const TriangleId t : star_.triangles) {
      if (tin_.is_alive(t)) carried_[t] = own;
    }
  }

  Tin tin_;
  std::vector<Carried> carried_;
  std::vector<int> last_;
  int pass_ = 0;
  Star star_;
  std::vector<VertexSplit> records_;
};

CoarsestTin coarsest_of(const Tin& tin) {
  CoarsestTin t0;
  std::vector<std::uint32_t> number(tin.vertices.size(), kNone);
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    if (tin.vertices[v].triangle != kNone) {
      number[v] = static_cast<std::uint32_t>(t0.vertices.size());
      t0.vertices.push_back({tin.position(v), tin.vertices[v].height, 1});
    }
  }
  for (const Triangle& t : tin.triangles) {
    if (t.v[0] != kNone)
      t0.triangles.push_back({{number[t.v[0]], number[t.v[1]], number[t.v[2]]}, 0});
  }
  return t0;
}

/// A store of its own, kept until the program ends: a file that changes while it is open is
/// refused.
class SyntheticFile {
 public:
  SyntheticFile()
      : path_((std::filesystem::temp_directory_path() /
               ("ptin_refine_bench_" + std::to_string(::getpid())))
                  .string()) {
    Passes passes;
    std::vector<VertexSplit> records = passes.run();
    const auto writer = StoreWriter::create(path_, {});
    writer->add_segment(records, {});
    StoreFacts facts;
    facts.bounds = {0, 0, kSide - 1, kSide - 1};
    facts.max_height = 100;
    facts.min_height = -100;
    writer->publish(facts, coarsest_of(passes.tin()), "{}");
  }
  ~SyntheticFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  SyntheticFile(const SyntheticFile&) = delete;
  SyntheticFile& operator=(const SyntheticFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The file of PTIN_BENCH_STORE when given (made by `ptin build`), the synthetic one otherwise.
const Terrain& store() {
  static const Terrain tin = [] {
    if (const char* path = std::getenv("PTIN_BENCH_STORE")) {
      return Terrain::open(path);
    }
    static const SyntheticFile file;
    return Terrain::open(file.path());
  }();
  return tin;
}

Region window_of(const benchmark::State& state) {
  const StoreFacts& f = store().store().facts();
  const double share = std::sqrt(static_cast<double>(state.range(0)) / 1e6);
  const double width = f.bounds.max_x - f.bounds.min_x;
  const double height = f.bounds.max_y - f.bounds.min_y;
  const double x = f.bounds.min_x + width * (1 - share) / 3;
  const double y = f.bounds.min_y + height * (1 - share) / 3;
  const MapPoint low = f.map.to_map(x, y);
  const MapPoint high = f.map.to_map(x + width * share, y + height * share);
  return Window{low.x, low.y, high.x, high.y};
}

void report(benchmark::State& state, std::uint64_t splits) {
  state.counters["splits"] = static_cast<double>(splits);
  state.counters["splits/s"] = benchmark::Counter(static_cast<double>(splits),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

void BM_RefineWindow(benchmark::State& state) {
  RefineRequest request;
  request.region = window_of(state);
  std::uint64_t splits = 0;
  for (auto _ : state) {
    const RefinedTin result = store().refine(request);
    benchmark::DoNotOptimize(result.tin.triangles.data());
    splits = result.cost.records_applied;
  }
  report(state, splits);
}

void BM_Retrieve(benchmark::State& state) {
  const StoreFile& file = store().store();
  const PredicatePtr window = meets_region(window_of(state), file.facts().map);
  std::uint64_t splits = 0;
  for (auto _ : state) {
    QueryContext context({.memory_bytes = UINT64_MAX}, "");
    splits = retrieve({file, file.index()}, *window, 0, context).size();
  }
  report(state, splits);
}

void BM_Apply(benchmark::State& state) {
  const StoreFile& file = store().store();
  const PredicatePtr window = meets_region(window_of(state), file.facts().map);
  QueryContext context({.memory_bytes = UINT64_MAX}, "");
  const std::vector<PendingSplit> splits = retrieve({file, file.index()}, *window, 0, context);
  const Tin t0 = mesh_of(file.t0(), "");
  for (auto _ : state) {
    Refinement refinement(t0);
    refinement.apply(splits, context);
    benchmark::DoNotOptimize(refinement.tin().triangles.data());
  }
  report(state, splits.size());
}

#define PTIN_WINDOWS \
  ->ArgName("area_ppm")->Arg(1000)->Arg(40000)->Arg(250000)->Unit(benchmark::kMillisecond)
BENCHMARK(BM_RefineWindow) PTIN_WINDOWS;
BENCHMARK(BM_Retrieve) PTIN_WINDOWS;
BENCHMARK(BM_Apply) PTIN_WINDOWS;

}  // namespace
