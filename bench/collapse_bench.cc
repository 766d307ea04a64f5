// SPDX-License-Identifier: GPL-3.0-or-later
//
// Collapses in memory, one thread: vertices a second of processor time.
//   BM_Simplify/tile:t/cost:c       one tile down to what no collapse is allowed in: queue, choice
//                                   of w, certificates, records
//   BM_CollapseAndSplit/tile:t      connectivity alone: half of the vertices of a tile collapsed
//                                   into the first allowed neighbour in a seeded order, then split
//                                   back; steps a second, one collapse or split each
// Tiles of 384 x 384 samples are cut from the south-western corner of real terrains (where
// PTIN_SHARED_DATA has them) or made: hills, noise (every residual large), flat (every error 0);
// random is the Delaunay triangulation of 100 000 points on hills. half_void is half void and a
// quarter sea. Cannot show: reading, tiles that join, tightening, writing (build_bench); terrains
// beyond the cache of the machine.
#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/counters.h"
#include "bench/support/scratch.h"
#include "bench/support/terrain.h"
#include "engine/construct/collapse/simplify.h"
#include "engine/mesh/collapse.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

constexpr std::int64_t kSide = 384;

struct RealTile {
  const char* name;
  const char* file;
  std::int64_t x0, y0;
};
constexpr RealTile kRealTiles[] = {
    {"mountains_30m", "srtm1_bigtujunga_utm_1197x643.tif", 0, 0},
    {"mountains_90m", "srtm3_rainier_1201.tif", 400, 400},
    {"moors_90m", "mosaic_northengland/northengland.vrt", 1800, 1200},
    {"half_void", "srtm1_n48w125_olympic_3601.tif", 600, 1608},
};

std::unique_ptr<MadeTerrain> make(const std::string& name) {
  if (name == "hills") return std::make_unique<MadeTerrain>(made_raster(kSide, Relief::kHills));
  if (name == "noise") return std::make_unique<MadeTerrain>(made_raster(kSide, Relief::kNoise));
  if (name == "flat") return std::make_unique<MadeTerrain>(made_raster(kSide, Relief::kFlat));
  if (name == "random") return std::make_unique<MadeTerrain>(random_terrain(100000, 1));
  for (const RealTile& t : kRealTiles) {
    if (const std::string path = shared_terrain(t.file); name == t.name && !path.empty()) {
      return std::make_unique<MadeTerrain>(raster_terrain(path, t.x0, t.y0, kSide));
    }
  }
  return nullptr;
}

/// Made on first use and kept.
const MadeTerrain* terrain(const std::string& name) {
  static std::map<std::string, std::unique_ptr<MadeTerrain>> made;
  const auto at = made.find(name);
  return (at != made.end() ? at->second : made[name] = make(name)).get();
}

void BM_Simplify(benchmark::State& state, const std::string& name, CostModel cost) {
  const MadeTerrain* t = terrain(name);
  if (t == nullptr) return state.SkipWithError("needs the larger terrains of PTIN_SHARED_DATA");
  SimplifyOptions options;
  options.cost = cost;
  std::size_t collapsed = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto tile = std::make_unique<Tile>(t->started.tile);
    state.ResumeTiming();
    simplify(*tile, *t->started.full, options);
    state.PauseTiming();
    collapsed = tile->records.size();
    tile.reset();
    state.ResumeTiming();
  }
  state.counters["vertices"] = double(t->started.tile.tin.vertices.size());
  state.counters["left"] = double(t->started.tile.tin.vertices.size() - collapsed);
  add_rate(state, "vertices/s", collapsed);
}

/// Collapses vertices in a seeded order into their first allowed neighbour, until half of them are
/// gone.
std::vector<SplitSite> collapse_half(Tin& tin) {
  std::vector<VertexId> order(tin.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
  order.resize(order.size() / 2);
  std::vector<SplitSite> sites;
  Star star;
  for (const VertexId u : order) {
    walk_star(tin, u, star);
    for (std::size_t j = 0; j < star.degree(); ++j) {
      if (!can_collapse(tin, star, j)) continue;
      const CollapseSite s = collapse(tin, star, j);
      sites.push_back({s.u, s.w, s.vl, s.vr, s.left != kNone, s.right != kNone});
      break;
    }
  }
  return sites;
}

void BM_CollapseAndSplit(benchmark::State& state, const std::string& name) {
  const MadeTerrain* t = terrain(name);
  if (t == nullptr) return state.SkipWithError("needs the larger terrains of PTIN_SHARED_DATA");
  std::size_t steps = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto tin = std::make_unique<Tin>(t->started.tile.tin);
    tin->triangles.reserve(2 * tin->triangles.size());
    tin->classes.reserve(2 * tin->triangles.size());
    state.ResumeTiming();
    const std::vector<SplitSite> sites = collapse_half(*tin);
    for (std::size_t i = sites.size(); i-- > 0;) split(*tin, sites[i]);
    state.PauseTiming();
    steps = 2 * sites.size();
    tin.reset();
    state.ResumeTiming();
  }
  add_rate(state, "steps/s", steps);
}

[[maybe_unused]] const bool registered = [] {
  constexpr std::pair<CostModel, const char*> kCosts[] = {
      {CostModel::kError, "error"}, {CostModel::kRoi, "roi"}, {CostModel::kElevation, "elevation"}};
  std::vector<std::string> names = {"hills", "noise", "flat", "random"};
  for (const RealTile& t : kRealTiles) names.emplace_back(t.name);
  for (const std::string& name : names) {
    for (const auto& [cost, cost_name] : kCosts) {
      benchmark::RegisterBenchmark(("BM_Simplify/tile:" + name + "/cost:" + cost_name).c_str(),
                                   BM_Simplify, name, cost)
          ->Unit(benchmark::kMillisecond);
    }
  }
  for (const char* name : {"hills", "random"}) {
    benchmark::RegisterBenchmark((std::string("BM_CollapseAndSplit/tile:") + name).c_str(),
                                 BM_CollapseAndSplit, std::string(name))
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
