// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stages of points: reading files, sorting into buckets on disk, and the triangles of tiles, where
// items are points of tiles, so that margins count as work and not as output.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/scratch.h"
#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/construct/points/point_source.h"
#include "engine/construct/read/las_reader.h"
#include "engine/construct/tasks/task_driver.h"
#include "tests/construct/memory_file.h"
#include "tests/support/las_file.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

enum Kind : int { kEven, kGrid, kClusters };

/// A LAS file of `n` points in memory.
std::string las_of(Kind kind, std::uint64_t n) {
  std::mt19937_64 random(1);
  LasFileMaker las;
  const auto side = static_cast<std::int32_t>(std::sqrt(static_cast<double>(n)));
  std::normal_distribution<double> normal(0.0, 1.0);
  for (std::uint64_t i = 0; i < n; ++i) {
    LasPoint p;
    if (kind == kGrid) {
      p.x = static_cast<std::int32_t>(i) % side;
      p.y = static_cast<std::int32_t>(i) / side;
    } else if (kind == kEven) {
      p.x = static_cast<std::int32_t>(random() % (100U * static_cast<unsigned>(side)));
      p.y = static_cast<std::int32_t>(random() % (100U * static_cast<unsigned>(side)));
    } else {
      const auto c = static_cast<std::int32_t>(random() % 20);
      p.x = c * 7919 % 20 * 300 * side +
            static_cast<std::int32_t>(normal(random) * side * 10 * (1 + c));
      p.y = c * 400 * side + static_cast<std::int32_t>(normal(random) * side * 10 * (1 + c));
    }
    p.z = static_cast<std::int32_t>(100 * std::sin(p.x * 1e-4) * std::cos(p.y * 1e-4));
    las.points.push_back(p);
  }
  return las.bytes();
}

/// Reads and sorts a file on one thread. The files of the buckets have no names any more.
PointBuckets sorted(const std::string& path, std::uint64_t memory) {
  const RunTasks run = [&](TaskList& tasks, TaskWorker& worker) {
    tasks.set_bytes(memory);
    run_alone(tasks, worker);
  };
  const test::TestFolder folder(std::filesystem::current_path());
  PointSource source({path}, {}, {{FileLayer::system(), folder.path()}, run});
  return source.sort(folder.file("buckets"), true);
}

const PointBuckets& buckets_of(Kind kind, std::uint64_t n) {
  static std::unique_ptr<PointBuckets> buckets;
  static int last_kind = -1;
  static std::uint64_t last_n = 0;
  if (!buckets || last_kind != kind || last_n != n) {
    const MemoryFile file("bench.las", las_of(kind, n));
    buckets = std::make_unique<PointBuckets>(sorted(file.path(), 64U << 20));
    last_kind = kind;
    last_n = n;
  }
  return *buckets;
}

void Tiles(benchmark::State& state) {
  const PointBuckets& buckets =
      buckets_of(static_cast<Kind>(state.range(0)), static_cast<std::uint64_t>(state.range(1)));
  const auto count = static_cast<std::uint64_t>(state.range(2));
  DelaunayTiler tiler(buckets);
  std::uint64_t points = 0, others = 0;
  for (auto _ : state) {
    for (std::uint64_t first = 0; first < buckets.size(); first += count) {
      const DelaunayTile tile = tiler.make(first, std::min(count, buckets.size() - first));
      benchmark::DoNotOptimize(tile.tin.triangles.data());
      points += tile.own_points;
      others += tile.other_points;
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(points));
  state.counters["margin"] = static_cast<double>(others) / static_cast<double>(points);
}
BENCHMARK(Tiles)
    ->ArgNames({"kind", "points", "tile"})
    ->Args({kEven, 1'000'000, 250'000})
    ->Args({kEven, 1'000'000, 65'536})
    ->Args({kGrid, 1'000'000, 250'000})
    ->Args({kClusters, 1'000'000, 250'000})
    ->Unit(benchmark::kMillisecond);

/// From a LAS file in memory to buckets on disk.
void Buckets(benchmark::State& state) {
  const MemoryFile file("bench.las", las_of(kEven, static_cast<std::uint64_t>(state.range(0))));
  for (auto _ : state) {
    const PointBuckets buckets =
        sorted(file.path(), static_cast<std::uint64_t>(state.range(1)) << 20);
    benchmark::DoNotOptimize(buckets.size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Buckets)
    ->ArgNames({"points", "memory"})
    ->Args({1'000'000, 64})
    ->Args({1'000'000, 2})
    ->Unit(benchmark::kMillisecond);

/// Points of a file, compressed or not, as a stream of decimals: time of the processor, a thread.
void Reading(benchmark::State& state, const char* name) {
  const std::string path = bench::shared_terrain(name);
  if (path.empty()) return state.SkipWithError("needs the larger terrains of PTIN_SHARED_DATA");
  std::uint64_t points = 0;
  for (auto _ : state) {
    LasReader reader(path, {});
    std::vector<SourcePoint> batch;
    while (reader.next(batch)) points += batch.size();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(points));
}
BENCHMARK_CAPTURE(Reading, las_format_3, "autzen_trim.las")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Reading, laz_format_3, "laz/autzen_trim.laz")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Reading, las_format_7, "ign_lidarhd_0382_6565_crop.las")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Reading, laz_format_7, "laz/ign_lidarhd_0382_6565_crop.laz")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ptin
