// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/first_pass.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/raster/raster_tile.h"
#include "engine/mesh/triangle_holds.h"
#include "engine/mesh/validate.h"
#include "tests/construct/collapse/first_pass_rasters.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::RasterSpec;
using oracle::TestTerrain;
using test::mountains;
using test::specs;

GridBox box_of_samples(const TestTerrain& terrain) {
  return {terrain.samples.front().position.x, terrain.samples.front().position.y,
          terrain.samples.back().position.x, terrain.samples.back().position.y};
}

/// The first sample that is not either a vertex or in one list, of a triangle that holds it.
std::string check_lists(const TestTerrain& terrain, const Tile& tile) {
  std::vector<int> found(terrain.samples.size(), 0);
  const GridBox box = box_of_samples(terrain);
  const std::int32_t width = box.max_x - box.min_x + 1;
  const auto count = [&](GridPoint p) {
    ++found[static_cast<std::size_t>(p.y - box.min_y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(p.x - box.min_x)];
  };
  for (const Vertex& v : tile.tin.vertices) {
    count(v.position);
  }
  for (TriangleId t = 0; t < tile.tin.triangles.size(); ++t) {
    for (const Sample& s : tile.samples.samples(tile.carried[t].samples)) {
      if (s.direction != kNoDirection) {
        if (!triangle_holds(tile.tin, tile.tin.triangles[t], s.position, s.direction)) {
          return "a witness is outside of its triangle";
        }
        continue;
      }
      for (std::int32_t y = 0; y < 1 << s.side_log; ++y) {
        for (std::int32_t x = 0; x < 1 << s.side_log; ++x) {
          const GridPoint p{s.position.x + x, s.position.y + y};
          count(p);
          if (!triangle_holds(tile.tin, tile.tin.triangles[t], p)) {
            return "a sample is outside of its triangle";
          }
        }
      }
    }
  }
  const bool each_once = std::all_of(found.begin(), found.end(), [](int n) { return n == 1; });
  return each_once ? "" : "a sample is nowhere, or twice";
}

TEST(FirstPass, LeavesAMeshWithinTheToleranceAndEverySampleInIt) {
  for (const RasterSpec& spec : test::some_of(specs())) {
    for (const double tolerance : test::some_of({0.5, 2.0, 7.0, 100.0})) {
      SCOPED_TRACE(spec.name + " within " + std::to_string(tolerance));
      TestTerrain terrain = oracle::make_raster(spec);
      run_first_pass(terrain.tile, *terrain.surface, box_of_samples(terrain), {}, tolerance);
      const Tile& tile = terrain.tile;
      ASSERT_EQ(validate(tile.tin), "");
      EXPECT_EQ(check_lists(terrain, tile), "");
      double error = 0.0;
      double deviation = 0.0;
      for (const VertexSplit& r : tile.records) {
        error = std::max(error, static_cast<double>(r.error));
        deviation = std::max(deviation, static_cast<double>(r.deviation));
      }
      EXPECT_LE(error, tolerance * (1 + 0x1p-20));
      EXPECT_EQ(oracle::check_samples(terrain, tile.tin, error), "");
      EXPECT_EQ(oracle::check_deviation(terrain, tile.tin, deviation), "");
    }
  }
}

TEST(FirstPass, TakesMostOfSmoothGroundAndNothingOfSteps) {
  RasterSpec smooth = mountains();
  smooth.code = [](int x, int y) { return static_cast<double>(3 * x + 2 * y); };
  RasterSpec steps = mountains();
  steps.code = [](int x, int y) {
    return static_cast<double>((x * x * 31 + y * y * 17 + x * y * 7) % 997);
  };
  const auto left = [](const RasterSpec& spec) {
    TestTerrain terrain = oracle::make_raster(spec);
    run_first_pass(terrain.tile, *terrain.surface, box_of_samples(terrain), {}, 1.0);
    return terrain.tile.tin.vertices.size();
  };
  EXPECT_GT(left(steps), 107U * 83U * 49 / 50);
  EXPECT_LT(left(smooth), 107U * 83U / 2);  // beside the border triangles grow by the row
}

TEST(FirstPass, KeepsTheWindowsBorder) {
  TestTerrain terrain = oracle::make_raster(mountains());
  run_first_pass(terrain.tile, *terrain.surface, box_of_samples(terrain), {}, 1000.0);
  std::size_t border = 0;
  for (const Vertex& v : terrain.tile.tin.vertices) {
    const GridPoint p = v.position;
    border += p.x == 0 || p.y == 0 || p.x == 106 || p.y == 82 ? 1 : 0;
  }
  EXPECT_EQ(border, 2U * (107 + 83) - 4);
}

/// A window of a raster at the origin, after its first pass.
Tile thinned_window(const TestTerrain& terrain, const SampleRange& raster,
                    const SampleRange& window, double tolerance) {
  RasterSamples samples;
  samples.raster = raster;
  samples.range = range_around(raster, window);
  samples.has_voids = samples.keep_around = true;
  const SampleRange& r = samples.range;
  for (std::int64_t y = r.y0; y < r.y0 + r.height; ++y) {
    for (std::int64_t x = r.x0; x < r.x0 + r.width; ++x) {
      const auto i = static_cast<std::size_t>(y * raster.width + x);
      samples.heights.push_back(terrain.full.vertices[i].height);
      samples.valid.push_back(terrain.full.has_height[i]);
    }
  }
  StartedTile started = start_raster_tile(std::move(samples), window, terrain.tile.units);
  run_first_pass(started.tile, *started.full, started.box, started.around, tolerance);
  return std::move(started.tile);
}

/// The vertices of a tile on the row (or column) `at` that is common to windows side by side.
std::vector<GridPoint> vertices_on(const Tile& tile, bool row, std::int32_t at) {
  std::vector<GridPoint> found;
  for (const Vertex& v : tile.tin.vertices) {
    if ((row ? v.position.y : v.position.x) == at) {
      found.push_back(v.position);
    }
  }
  return found;
}

/// The first fault of the records of a window, or of a sample of it that has a height.
std::string check_window(const TestTerrain& terrain, const Tile& tile, const GridBox& box,
                         double tolerance) {
  double error = 0.0;
  for (const VertexSplit& r : tile.records) {
    error = std::max(error, static_cast<double>(r.error));
    if (r.deviation < r.error) {
      return "a deviation is less than its error";
    }
  }
  if (error > tolerance * (1 + 0x1p-20)) {
    return "an error is above the tolerance";
  }
  TestTerrain part;
  part.tile.units = terrain.tile.units;
  for (const oracle::PlainSample& s : terrain.samples) {
    if (contains(box, s.position)) {
      part.samples.push_back(s);
    }
  }
  return oracle::check_samples(part, tile.tin, error);
}

TEST(FirstPass, NeighboursLeaveTheSameSamplesOnTheirCommonSide) {
  for (RasterSpec spec : test::some_of(specs())) {
    if (spec.origin != GridPoint{} || spec.width < 100) {
      continue;
    }
    spec.width = 171;  // two columns of 64 cells, the last with a rest
    spec.height = 149;
    const TestTerrain terrain = oracle::make_raster(spec);
    const SampleRange raster{0, 0, spec.width, spec.height};
    for (const double tolerance : test::some_of({0.5, 2.0, 7.0, 100.0})) {
      SCOPED_TRACE(spec.name + " within " + std::to_string(tolerance));
      const std::array<SampleRange, 4> windows{
          {{0, 0, 65, 65}, {64, 0, 107, 65}, {0, 64, 65, 85}, {64, 64, 107, 85}}};
      std::vector<Tile> tiles;
      for (const SampleRange& w : windows) {
        tiles.push_back(thinned_window(terrain, raster, w, tolerance));
        ASSERT_EQ(validate(tiles.back().tin), "");
        const GridBox box{static_cast<std::int32_t>(w.x0), static_cast<std::int32_t>(w.y0),
                          static_cast<std::int32_t>(w.x0 + w.width - 1),
                          static_cast<std::int32_t>(w.y0 + w.height - 1)};
        if (!spec.valid) {  // the border of voids is that of the whole: a build's matter, below
          EXPECT_EQ(check_window(terrain, tiles.back(), box, tolerance), "");
        }
      }
      EXPECT_EQ(vertices_on(tiles[0], false, 64), vertices_on(tiles[1], false, 64));
      EXPECT_EQ(vertices_on(tiles[2], false, 64), vertices_on(tiles[3], false, 64));
      EXPECT_EQ(vertices_on(tiles[0], true, 64), vertices_on(tiles[2], true, 64));
      EXPECT_EQ(vertices_on(tiles[1], true, 64), vertices_on(tiles[3], true, 64));
      if (tolerance == 100.0 && !spec.valid) {
        // Every eighth, and two beside the raster's own side, which keeps all of its samples.
        EXPECT_EQ(vertices_on(tiles[0], true, 64).size(), 9U + 2U);
      }
    }
  }
}

/// Each height that the tile holds lies between those of its triangle's record.
TEST(FirstPass, RecordsCoverTheHeightsOfTheirTriangles) {
  TestTerrain terrain = oracle::make_raster(mountains());
  run_first_pass(terrain.tile, *terrain.surface, box_of_samples(terrain), {}, 7.0);
  const Tile& tile = terrain.tile;
  std::size_t held = 0;
  for (const CarriedState& carried : tile.carried) {
    for (const Sample& s : tile.samples.samples(carried.samples)) {
      ASSERT_NE(carried.record, kNone);
      const VertexSplit& r = tile.records[carried.record];
      const double code = tile.units.heights.code(s.height);
      EXPECT_LE(tile.units.heights.code(r.height_lo), code);
      EXPECT_GE(tile.units.heights.code(r.height_hi), code);
      ++held;
    }
  }
  EXPECT_GT(held, 1000U);
}

}  // namespace
}  // namespace ptin
