// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/test_terrain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/construct/raster/raster_tile.h"
#include "engine/geometry/infinity.h"
#include "engine/mesh/raster_tin.h"
#include "tests/construct/border_oracle.h"
#include "tests/construct/delaunay_tin.h"
#include "tests/construct/tin_surface.h"

namespace ptin::oracle {

namespace {

MeasureUnits units_of(const HeightEncoding& heights, double slope) {
  MeasureUnits units;
  units.heights = heights;
  units.quantum_code = heights.type == HeightType::int32 ? 1.0 : 1.0 / 16;
  units.void_slope_code = slope / heights.step;
  units.exact_codes = heights.type == HeightType::int32;
  return units;
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

}  // namespace

TestTerrain make_sampled(const std::string& name, int width, int height,
                         const std::vector<HeightBits>& heights, std::vector<std::uint8_t> valid,
                         const HeightEncoding& encoding, GridPoint origin, double slope) {
  TestTerrain terrain;
  terrain.name = name;
  terrain.slope = slope;
  const SampleRange all{origin.x, origin.y, width, height};
  terrain.full = make_raster_tin(heights, valid, all, encoding);
  if (drop_lone(terrain.full, valid)) {
    terrain.full = make_raster_tin(heights, valid, all, encoding);
  }
  terrain.samples = samples_of(terrain.full, encoding);
  measure_depths(terrain);
  StartedTile started = start_raster_tile(RasterSamples{all, all, heights, valid, true, {}}, all,
                                          units_of(encoding, slope));
  terrain.tile = std::move(started.tile);
  terrain.surface = std::move(started.full);
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
  start_tile(terrain.tile, nullptr);
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
