// SPDX-License-Identifier: GPL-3.0-or-later
//
// The whole build, from a raster on disk to a published and synced store: one build an iteration.
//   BM_Build/terrain:t/cost:c/max_error:E    vertices a second (those of the full TIN, void ones
//                                            counted), of processor time of all threads together:
//                                            what one core does, also on a busy machine
// Counters: seconds_wall is the time on the clock; samples/s counts samples with a height alone;
// bytes_per_vertex is of the file; peak_MB is the largest resident memory of the process so far (so
// run one terrain at a time to have its own). Cannot show: a cold source (it is read from the page
// cache after the first build), several threads, terrains larger than memory.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "bench/support/counters.h"
#include "bench/support/scratch.h"
#include "engine/construct/build.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

double peak_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024;
}

void BM_Build(benchmark::State& state, const std::string& file, CostModel cost, double max_error) {
  const std::string raster = shared_terrain(file);
  if (raster.empty()) return state.SkipWithError("needs the larger terrains of PTIN_SHARED_DATA");
  const ScratchFolder folder;
  BuildOptions options;
  options.cost = cost;
  options.max_error = max_error;
  BuildResources resources;
  resources.overwrite = true;
  BuildReport report;
  double seconds = 0;
  for (auto _ : state) {
    report = build({raster}, folder.file("out.ptin"), options, resources);
    seconds += report.seconds;
  }
  state.counters["vertices"] = double(report.vertices);
  state.counters["t0"] = double(report.t0_vertices);
  state.counters["rank"] = double(report.max_rank);
  add_rate(state, "vertices/s", report.vertices);
  add_rate(state, "samples/s", report.source_samples);
  state.counters["seconds_wall"] = seconds / double(state.iterations());
  state.counters["bytes_per_vertex"] =
      double(report.file_bytes) / double(report.records + report.t0_vertices);
  state.counters["peak_MB"] = peak_mb();
}

[[maybe_unused]] const bool registered = [] {
  const auto add = [](const std::string& name, const char* file, const char* cost_name,
                      double max_error) {
    const CostModel cost = std::string(cost_name) == "roi"         ? CostModel::kRoi
                           : cost_name == std::string("elevation") ? CostModel::kElevation
                                                                   : CostModel::kError;
    const std::string title = "BM_Build/terrain:" + name + "/cost:" + cost_name +
                              "/max_error:" + std::to_string(static_cast<int>(max_error));
    benchmark::RegisterBenchmark(title.c_str(), BM_Build, std::string(file), cost, max_error)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1)
        ->MeasureProcessCPUTime();
  };
  constexpr const char* kTujunga = "srtm1_bigtujunga_utm_1197x643.tif";
  constexpr const char* kRainier = "srtm3_rainier_1201.tif";
  add("bigtujunga", kTujunga, "error", 0);
  add("bigtujunga", kTujunga, "roi", 0);
  add("bigtujunga", kTujunga, "elevation", 0);
  add("rainier", kRainier, "error", 0);
  add("rainier", kRainier, "error", 5);
  add("northengland", "mosaic_northengland/northengland.vrt", "error", 0);
  add("northengland", "mosaic_northengland/northengland.vrt", "error", 5);
  add("olympic_half_void", "srtm1_n48w125_olympic_3601.tif", "error", 0);
  return true;
}();

}  // namespace
