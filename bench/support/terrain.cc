// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "engine/construct/raster/raster_surface.h"
#include "engine/construct/tile/part_surface.h"
#include "engine/mesh/raster_tin.h"
#include "tests/construct/delaunay_tin.h"

namespace ptin::bench {

namespace {

constexpr std::int32_t kUnitSquare = std::int32_t{1} << 24;
constexpr double kVoidSlope = 0.1;

/// A sum of plane waves over the unit square, between about -500 and 500.
class Hills {
 public:
  explicit Hills(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    double sum = 0;
    for (Wave& w : waves_) {
      const double periods = std::exp2(7 * unit(random));
      const double turn = 2 * std::numbers::pi * unit(random);
      w = {periods * std::cos(turn), periods * std::sin(turn), unit(random), 1 / periods};
      sum += w.amplitude;
    }
    for (Wave& w : waves_) w.amplitude *= 1000 / sum;
  }
  [[nodiscard]] double at(double x, double y) const {
    double height = 0;
    for (const Wave& w : waves_) {
      height += w.amplitude * std::sin(2 * std::numbers::pi * (w.x * x + w.y * y + w.phase));
    }
    return height;
  }

 private:
  struct Wave {
    double x, y, phase, amplitude;
  };
  Wave waves_[48];
};

/// Heights of a relief, in whole millimetres.
class MadeHeights {
 public:
  MadeHeights(Relief relief, std::uint64_t seed) : relief_(relief), hills_(seed), random_(seed) {}
  [[nodiscard]] double code(double x, double y) {
    if (relief_ == Relief::kHills) return std::round(1000 * hills_.at(x, y));
    return relief_ == Relief::kFlat
               ? 0
               : std::round(std::uniform_real_distribution<double>(0, 1e6)(random_));
  }

 private:
  Relief relief_;
  Hills hills_;
  std::mt19937_64 random_;
};

TerrainFrame millimetre_frame() {
  TerrainFrame frame;
  frame.heights = {HeightType::int32, 0.001, 0.0};
  frame.height_quantum = 0.001;
  frame.min_height = -1000;
  frame.max_height = 1000;
  return frame;
}

}  // namespace

MadeTerrain terrain_of(const GridPoints& points, const TerrainFrame& frame) {
  MadeTerrain terrain;
  terrain.frame = frame;
  Tile& tile = terrain.started.tile;
  tile.units = measure_units(frame, kVoidSlope);
  tile.tin = make_delaunay_tin(points.positions, points.heights);
  start_tile(tile, nullptr);
  terrain.started.full = std::make_unique<PartSurface>(tile.tin, frame.heights);
  return terrain;
}

MadeTerrain random_terrain(std::size_t count, std::uint64_t seed, Relief relief) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> coordinate(0, kUnitSquare);
  std::vector<VertexKey> keys;
  while (keys.size() < count) {
    while (keys.size() < count) {
      const std::int32_t x = coordinate(random);
      keys.push_back(key_of({x, coordinate(random)}));
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  }
  const TerrainFrame frame = millimetre_frame();
  MadeHeights heights(relief, seed);
  GridPoints points;
  for (const VertexKey key : keys) {
    const GridPoint p = point_of(key);
    points.positions.push_back(p);
    points.heights.push_back(
        frame.heights.bits(heights.code(p.x / double{kUnitSquare}, p.y / double{kUnitSquare})));
  }
  return terrain_of(points, frame);
}

MadeTerrain raster_terrain(const std::string& path, std::int64_t x0, std::int64_t y0,
                           std::int64_t side) {
  const RasterSource source = RasterSource::open({path}, {});
  MadeTerrain terrain;
  terrain.frame = source.frame();
  const SampleRange range = {x0, y0, std::min(side, source.width() - x0),
                             std::min(side, source.height() - y0)};
  terrain.started = start_raster_tile(source, range, measure_units(terrain.frame, kVoidSlope));
  return terrain;
}

MadeTerrain made_raster(std::int32_t side, Relief relief) {
  MadeTerrain terrain;
  terrain.frame = millimetre_frame();
  const HeightEncoding& encoding = terrain.frame.heights;
  MadeHeights made(relief, 1);
  std::vector<HeightBits> heights;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x)
      heights.push_back(encoding.bits(made.code(x / double(side), y / double(side))));
  }
  std::vector<std::uint8_t> valid(heights.size(), 1);
  Tile& tile = terrain.started.tile;
  tile.units = measure_units(terrain.frame, kVoidSlope);
  tile.tin = make_raster_tin(heights, valid, {0, 0, side, side}, encoding);
  start_tile(tile, nullptr);
  terrain.started.full = std::make_unique<RasterSurface>(std::move(heights), std::move(valid),
                                                         SampleRange{0, 0, side, side}, encoding);
  return terrain;
}

}  // namespace ptin::bench
