// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/test_terrain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/construct/raster/raster_surface.h"
#include "engine/construct/raster/raster_tin.h"
#include "engine/geometry/infinity.h"
#include "tests/construct/delaunay_tin.h"
#include "tests/construct/tin_surface.h"

namespace ptin::oracle {

namespace {

constexpr int kCutOff = 64;

MeasureUnits units_of(const HeightEncoding& heights, double slope) {
  MeasureUnits units;
  units.heights = heights;
  units.quantum_code = heights.type == HeightType::int32 ? 1.0 : 1.0 / 16;
  units.void_slope_code = slope / heights.step;
  units.exact_codes = heights.type == HeightType::int32;
  return units;
}

/// Distance to the nearest sample of the other class, by looking at all in reach, nearest rows
/// first.
double depth_at(const std::vector<std::uint8_t>& valid, int width, int height, int x, int y) {
  const auto at = [&](int i, int j) { return valid[static_cast<std::size_t>(j * width + i)] != 0; };
  int least = kCutOff * kCutOff + 1;
  for (int dy = 0; dy * dy < least; ++dy) {
    for (const int j : {y - dy, y + dy}) {
      for (int dx = 0; j >= 0 && j < height && dx * dx + dy * dy < least; ++dx) {
        if ((x - dx >= 0 && at(x - dx, j) != at(x, y)) ||
            (x + dx < width && at(x + dx, j) != at(x, y))) {
          least = dx * dx + dy * dy;
        }
      }
    }
  }
  return least > kCutOff * kCutOff ? kInfinity : std::sqrt(least);
}

/// Samples with heights that no surface triangle touches become void.
bool drop_lone(const Tin& tin, std::vector<std::uint8_t>& valid) {
  std::vector<std::uint8_t> touched(tin.vertices.size(), 0);
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    for (const VertexId v : tin.triangles[t].v) {
      if (tin.classes[t] == TriangleClass::kSurface) {
        touched[v] = 1;
      }
    }
  }
  bool dropped = false;
  for (std::size_t v = 0; v < valid.size(); ++v) {
    dropped |= valid[v] != 0 && touched[v] == 0;
    valid[v] = static_cast<std::uint8_t>(valid[v] & touched[v]);
  }
  return dropped;
}

std::vector<PlainSample> samples_of(const Tin& tin, const HeightEncoding& heights) {
  std::vector<PlainSample> samples;
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    const bool has_height = tin.has_height[v] != 0;
    samples.push_back({tin.vertices[v].position,
                       has_height ? heights.code(tin.vertices[v].height) : 0.0, has_height,
                       kInfinity});
  }
  return samples;
}

void set_depths(TestTerrain& terrain, const std::vector<std::uint8_t>& valid, int width, int height,
                std::vector<float>& depths) {
  const bool mixed = std::find(valid.begin(), valid.end(), 0) != valid.end() &&
                     std::find(valid.begin(), valid.end(), 1) != valid.end();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double depth = mixed ? depth_at(valid, width, height, x, y) : kInfinity;
      depths.push_back(static_cast<float>(depth));
      terrain.samples[static_cast<std::size_t>(y * width + x)].depth = depths.back();
    }
  }
}

}  // namespace

TestTerrain make_sampled(const std::string& name, int width, int height,
                         const std::vector<HeightBits>& heights, std::vector<std::uint8_t> valid,
                         const HeightEncoding& encoding, GridPoint origin, double slope) {
  TestTerrain terrain;
  terrain.name = name;
  terrain.slope = slope;
  terrain.full = make_raster_tin(heights, valid, width, height, encoding, origin);
  if (drop_lone(terrain.full, valid)) {
    terrain.full = make_raster_tin(heights, valid, width, height, encoding, origin);
  }
  terrain.samples = samples_of(terrain.full, encoding);
  std::vector<float> depths;
  if (std::find(valid.begin(), valid.end(), 0) != valid.end()) {
    set_depths(terrain, valid, width, height, depths);
  }
  terrain.tile.units = units_of(encoding, slope);
  terrain.tile.samples_fill_grid = true;
  terrain.tile.tin = terrain.full;
  start_tile(terrain.tile, depths);
  terrain.surface =
      std::make_unique<RasterSurface>(heights, valid, width, height, encoding, origin);
  return terrain;
}

TestTerrain make_raster(const RasterSpec& spec) {
  std::vector<HeightBits> heights;
  std::vector<std::uint8_t> valid;
  for (int y = 0; y < spec.height; ++y) {
    for (int x = 0; x < spec.width; ++x) {
      valid.push_back(!spec.valid || spec.valid(x, y) ? 1 : 0);
      const double code = spec.code(x, y);
      heights.push_back(
          spec.heights.bits(spec.heights.type == HeightType::int32 ? std::nearbyint(code) : code));
    }
  }
  return make_sampled(spec.name, spec.width, spec.height, heights, valid, spec.heights, spec.origin,
                      spec.slope);
}

TestTerrain make_points(const PointSpec& spec) {
  std::vector<GridPoint> positions = spec.positions;
  std::sort(positions.begin(), positions.end(),
            [](GridPoint a, GridPoint b) { return key_of(a) < key_of(b); });
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  std::vector<HeightBits> heights;
  for (const GridPoint p : positions) {
    const double code = spec.code(p);
    heights.push_back(
        spec.heights.bits(spec.heights.type == HeightType::int32 ? std::nearbyint(code) : code));
  }
  TestTerrain terrain;
  terrain.name = spec.name;
  terrain.full = make_delaunay_tin(positions, heights);
  terrain.samples = samples_of(terrain.full, spec.heights);
  terrain.tile.units = units_of(spec.heights, terrain.slope);
  terrain.tile.tin = terrain.full;
  start_tile(terrain.tile, {});
  terrain.surface = std::make_unique<TinSurface>(terrain.full, spec.heights);
  return terrain;
}

TestTerrain simplified(TestTerrain terrain, CostModel cost) {
  SimplifyOptions options;
  options.cost = cost;
  options.compact_above = SIZE_MAX;  // the oracles go by the ids of the full TIN
  simplify(terrain.tile, *terrain.surface, options);
  return terrain;
}

}  // namespace ptin::oracle
