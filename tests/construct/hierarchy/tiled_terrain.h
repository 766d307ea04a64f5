// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains built over a tree of tiles in memory, and everything that is promised of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/raster/raster_tile.h"
#include "engine/construct/tile_tasks/build_hierarchy.h"
#include "engine/mesh/validate.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin::test {

/// The samples of a raster terrain at the grid's origin, as something that leaves start from.
class SampledRaster {
 public:
  explicit SampledRaster(const oracle::TestTerrain& terrain) : terrain_(terrain) {
    for (const oracle::PlainSample& s : terrain.samples) {
      box_ = united(box_, s.position);
    }
  }
  [[nodiscard]] bool at_origin() const {
    return box_.min_x == 0 && box_.min_y == 0 &&
           terrain_.samples.size() == static_cast<std::size_t>(width() * height());
  }
  [[nodiscard]] std::int64_t width() const { return std::int64_t{box_.max_x} - box_.min_x + 1; }
  [[nodiscard]] std::int64_t height() const { return std::int64_t{box_.max_y} - box_.min_y + 1; }

  [[nodiscard]] StartedTile start(const SampleRange& w) const {
    RasterSamples samples;
    samples.raster = {0, 0, width(), height()};
    samples.range = range_around(samples.raster, w);
    samples.has_voids = true;
    const SampleRange& r = samples.range;
    for (std::int64_t y = r.y0; y < r.y0 + r.height; ++y) {
      for (std::int64_t x = r.x0; x < r.x0 + r.width; ++x) {
        const auto i = static_cast<std::size_t>(y * width() + x);
        samples.heights.push_back(terrain_.full.vertices[i].height);
        samples.valid.push_back(terrain_.full.has_height[i]);
      }
    }
    return start_raster_tile(std::move(samples), w, terrain_.tile.units);
  }

 private:
  const oracle::TestTerrain& terrain_;
  GridBox box_;
};

struct Built {
  Tin t0;
  std::vector<VertexSplit> records;
};

inline Built build_tiled(const oracle::TestTerrain& terrain, std::int64_t side, int threads = 1) {
  const SampledRaster raster(terrain);
  const oracle::ScratchFolder folder;
  UnsyncedFiles files;
  Workspace workspace(files, folder.file("t.ptin"), "", Unfinished::kRefuse, {});
  RecordsInMemory output;
  HierarchyOptions options;
  options.collapse.units = terrain.tile.units;
  options.threads = threads;
  const TileTree tree(raster.width(), raster.height(), side);
  Built built;
  built.t0 =
      build_hierarchy(
          [&]() -> LeafStarter { return [&](const SampleRange& w) { return raster.start(w); }; },
          tree, options, workspace, output)
          .t0;
  built.records = output.records();
  for (const VertexSplit& r : built.records) {  // the oracle wants every vertex to have its place
    built.t0.vertices.push_back({r.u, r.height, kNone});
    built.t0.has_height.push_back((r.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0);
  }
  return built;
}

/// Some of the errors that occur, each also a step below; 0 and everything.
inline std::vector<double> tolerances(const std::vector<VertexSplit>& records) {
  std::vector<float> errors;
  for (const VertexSplit& r : records) {
    if (std::isfinite(r.error)) {
      errors.push_back(r.error);
    }
  }
  std::sort(errors.begin(), errors.end());
  std::vector<double> all{0.0, std::numeric_limits<double>::max()};
  for (const std::size_t percent : {50U, 90U, 99U}) {
    if (!errors.empty()) {
      const float e = errors[errors.size() * percent / 100];
      all.push_back(e);
      all.push_back(std::nextafter(e, 0.0F));
    }
  }
  return all;
}

inline std::string check_tolerance(const oracle::TestTerrain& terrain, const Built& built,
                                   double tolerance) {
  std::string fault;
  double deviation = 0.0;
  const auto needed = [&](const VertexSplit& r) {
    const bool is = static_cast<double>(r.error) > tolerance;
    deviation = is ? deviation : std::max(deviation, static_cast<double>(r.deviation));
    return is;
  };
  const Tin tin = oracle::refined(built.t0, built.records, needed, fault);
  for (const auto& check : {std::function<std::string()>([&] { return validate(tin); }),
                            {[&] { return oracle::check_samples(terrain, tin, tolerance); }},
                            {[&] { return oracle::check_deviation(terrain, tin, deviation); }}}) {
    fault = fault.empty() ? check() : fault;
  }
  return fault;
}

/// Everything that is promised of a terrain in tiles; the first fault in words.
inline std::string check_tiled(const oracle::TestTerrain& terrain, std::int64_t side) {
  const Built built = build_tiled(terrain, side);
  std::string fault = validate(built.t0);
  const auto all = [](const VertexSplit&) { return true; };
  const Tin full = oracle::refined(built.t0, built.records, all, fault);
  if (fault.empty() && oracle::named_triangles(full) != oracle::named_triangles(terrain.full)) {
    fault = "all records do not give back the full TIN";
  }
  for (const double tolerance : some_of(tolerances(built.records))) {
    fault = fault.empty() ? check_tolerance(terrain, built, tolerance) : fault;
  }
  return fault.empty() ? fault : terrain.name + ", tiles of " + std::to_string(side) + ": " + fault;
}

/// Hills of several sizes, and a mask of blobs when `voids`.
inline oracle::TestTerrain hills(int size, unsigned seed, bool voids) {
  oracle::RasterSpec spec;
  spec.name = "hills " + std::to_string(seed);
  spec.width = spec.height = size;
  spec.code = [seed](int x, int y) {
    return 400.0 * std::sin(0.05 * x + seed) * std::cos(0.04 * y) +
           60.0 * std::sin(0.3 * x + 0.2 * y) +
           static_cast<double>((static_cast<unsigned>(x) * 73856093U ^
                                static_cast<unsigned>(y) * 19349663U ^ seed) %
                               12);
  };
  if (voids) {
    spec.valid = [](int x, int y) { return std::sin(0.2 * x) + std::cos(0.17 * y) < 0.9; };
  }
  return oracle::make_raster(spec);
}

/// Hills with so many samples along a side have 4 x 4 tiles of 40.
inline constexpr int kSamplesAlong = 161;

}  // namespace ptin::test
