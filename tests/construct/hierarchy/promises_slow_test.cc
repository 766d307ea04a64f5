// SPDX-License-Identifier: GPL-3.0-or-later
//
// The promises on real terrains, on large flat ones, and on more random ones than the fast tests
// have time for.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/mesh/star.h"
#include "engine/mesh/validate.h"
#include "tests/construct/point_source.h"
#include "tests/construct/record_oracle.h"
#include "tests/construct/surface_oracle.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

std::string check_at(const TestTerrain& terrain, double tolerance) {
  std::string fault;
  double deviation = 0.0;
  const auto needed = [&](const VertexSplit& r) {
    const bool is = static_cast<double>(r.error) > tolerance;
    deviation = is ? deviation : std::max(deviation, static_cast<double>(r.deviation));
    return is;
  };
  const Tin tin = oracle::refined(terrain.tile.tin, terrain.tile.records, needed, fault);
  fault = fault.empty() ? validate(tin) : fault;
  fault = fault.empty() ? oracle::check_samples(terrain, tin, tolerance) : fault;
  return fault.empty() ? oracle::check_deviation(terrain, tin, deviation) : fault;
}

void expect_full_again(const TestTerrain& terrain) {
  std::string fault;
  const auto all = [](const VertexSplit&) { return true; };
  const Tin tin = oracle::refined(terrain.tile.tin, terrain.tile.records, all, fault);
  EXPECT_EQ(fault, "");
  EXPECT_TRUE(oracle::named_triangles(tin) == oracle::named_triangles(terrain.full));
}

/// A square window of a real raster, of so many samples a side: of two thirds of them, where not all
/// cases are asked for, since what is checked there grows faster than its samples. Depths in samples.
TestTerrain read_window(const std::string& path, std::int64_t x0, std::int64_t y0,
                        std::int64_t whole) {
  const RasterSource source = RasterSource::open({path}, {});
  const std::int64_t side = 2 * whole / (1 + test::share_of_cases(2));
  const std::int64_t w = std::min(side, source.width() - x0);
  const std::int64_t h = std::min(side, source.height() - y0);
  std::vector<HeightBits> heights(static_cast<std::size_t>(w * h));
  std::vector<std::uint8_t> valid(heights.size());
  source.read({x0, y0, w, h}, heights, valid);
  return oracle::make_sampled(std::filesystem::path(path).filename().string(), static_cast<int>(w),
                              static_cast<int>(h), heights, valid, source.frame().heights, {}, 0.1);
}

void expect_promises(TestTerrain started) {
  const TestTerrain terrain = oracle::simplified(std::move(started));
  SCOPED_TRACE(terrain.name);
  EXPECT_LE(terrain.tile.tin.alive_vertices(), 500U);
  EXPECT_EQ(validate(terrain.tile.tin), "");
  EXPECT_EQ(oracle::check_records(terrain, false), "");
  expect_full_again(terrain);
  for (const double tolerance : {0.0, 0.5, 2.0, 10.0, 50.0, 1e30}) {
    EXPECT_EQ(check_at(terrain, tolerance), "");
  }
}

TEST(PromisesOnRealTerrain, HoldForTheTerrainsOfTheTree) {
  const std::string data = PTIN_TEST_DATA;
  expect_promises(read_window(data + "/mountains_257.tif", 0, 0, 150));
  expect_promises(read_window(data + "/coast_257.tif", 60, 100, 150));
  const PointSet points = read_points({data + "/ground_points.csv"}, {});
  std::size_t i = 0;
  TestTerrain terrain = oracle::make_points(
      {"ground points", points.positions,
       [&](GridPoint) { return points.frame.heights.code(points.heights[i++]); },
       points.frame.heights});
  expect_promises(std::move(terrain));
}

TEST(PromisesOnRealTerrain, HoldForLargerTerrains) {
  const std::string data = PTIN_SHARED_DATA;
  if (!std::filesystem::exists(std::filesystem::path(data) / "ned13_portland_nodata.tif")) {
    GTEST_SKIP() << "needs " << data;
  }
  expect_promises(read_window(data + "/ned13_portland_nodata.tif", 100, 200, 100));
  expect_promises(read_window(data + "/lidar_dtm1m_slovenia_564_146.tif", 300, 300, 100));
  expect_promises(read_window(data + "/dtm5m_austria_alr_float64.tif", 10, 10, 100));
  expect_promises(read_window(data + "/srtm1_n48w125_olympic_3601.tif", 2600, 1500, 130));
  expect_promises(read_window(data + "/srtm3_n53e027_minsk_uint16.tif", 300, 300, 100));
}

TEST(PromisesOnRandomTerrain, HoldForManySeeds) {
  for (std::uint64_t seed = 1000; seed < 1400;
       seed += static_cast<std::uint64_t>(test::share_of_cases(4))) {
    const TestTerrain terrain =
        oracle::simplified(oracle::random_terrain(seed, 60 + static_cast<int>(seed % 400)),
                           static_cast<CostModel>(seed % 3));
    ASSERT_EQ(oracle::check_records(terrain, false), "");
    const auto& records = terrain.tile.records;
    for (std::size_t i = 0; i < 5 && !records.empty(); ++i) {
      const float error = records[i * (records.size() - 1) / 4].error;
      ASSERT_EQ(check_at(terrain, std::isfinite(error) ? error : 1e30), "");
    }
    expect_full_again(terrain);
  }
}

TEST(Simplify, RecordsOfLakesAreNotBelowTheDefinition) {
  for (const auto& make : oracle::lakes()) {
    EXPECT_EQ(oracle::check_records(oracle::simplified(make()), false), "");
  }
}

TEST(Simplify, BlocksOfSamplesCostFewVertices) {
  // A block that lies across a spoke is charged whole, so errors beside voids may be larger than
  // they need to be: by how much is seen in the vertices that a tolerance takes.
  for (const auto& make : oracle::lakes()) {
    TestTerrain one_by_one = make();
    SCOPED_TRACE(one_by_one.name);
    one_by_one.tile.samples_fill_grid = false;
    one_by_one = oracle::simplified(std::move(one_by_one));
    EXPECT_EQ(oracle::check_records(one_by_one), "");
    const TestTerrain in_blocks = oracle::simplified(make());
    for (const float tolerance : {0.0F, 0.3F, 1.0F, 3.0F, 10.0F, 30.0F}) {
      const auto needed = [&](const TestTerrain& terrain) {
        const auto& records = terrain.tile.records;
        return std::count_if(records.begin(), records.end(),
                             [&](const VertexSplit& r) { return r.error > tolerance; });
      };
      const auto few = needed(one_by_one);
      EXPECT_LE(needed(in_blocks), few + few / 20 + 5) << tolerance;
    }
  }
}

TEST(Promises, HoldOnLakes) {
  for (const auto& make : oracle::lakes()) {
    const TestTerrain terrain = oracle::simplified(make());
    for (const double tolerance : {0.0, 0.3, 1.0, 3.0, 10.0, 1e30}) {
      EXPECT_EQ(check_at(terrain, tolerance), "");
    }
  }
}

TEST(Simplify, LeavesFewVerticesWhateverTheMask) {
  std::size_t most = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::mt19937_64 random(seed);
    const int side = 20 + static_cast<int>(random() % 60);
    const auto block = static_cast<int>(1 + random() % 6);
    const std::uint64_t share = random() % 100;
    std::vector<bool> mask(static_cast<std::size_t>(side * side));
    for (auto&& m : mask) {
      m = random() % 100 < share;
    }
    TestTerrain terrain = oracle::simplified(oracle::make_raster(
        {"mask " + std::to_string(seed),
         side,
         side,
         [](int x, int y) { return std::floor(9 * std::sin(0.3 * x + 0.2 * y)); },
         [&](int x, int y) { return mask[static_cast<std::size_t>(y / block * side + x / block)]; },
         {HeightType::int32, 1.0, 0.0},
         {},
         0.1}));
    EXPECT_LE(terrain.tile.tin.alive_vertices(), 500U) << terrain.name;
    most = std::max(most, terrain.tile.tin.alive_vertices());
  }
  std::cout << "largest T0: " << most << " vertices\n";
}

/// The largest degree that a vertex ever has, from the tile's own counts after every few collapses.
std::size_t largest_degree(TestTerrain terrain, CostModel cost) {
  std::size_t largest = 0;
  for (std::uint64_t keep = terrain.full.vertices.size(); keep > 4; keep -= keep / 20 + 1) {
    SimplifyOptions options;
    options.cost = cost;
    options.keep = keep;
    simplify(terrain.tile, *terrain.surface, options);
    for (VertexId v = 0; v < terrain.full.vertices.size(); ++v) {
      if (terrain.tile.tin.vertices[v].triangle != kNone) {
        largest = std::max<std::size_t>(largest, terrain.tile.vertex_state[v].degree);
      }
    }
  }
  return largest;
}

TEST(Simplify, KeepsDegreesComfortableOnAFlatSea) {
  for (const CostModel cost : {CostModel::kError, CostModel::kRoi, CostModel::kElevation}) {
    const std::size_t degree = largest_degree(oracle::make_raster({"sea",
                                                                   200,
                                                                   200,
                                                                   [](int, int) { return 0.0; },
                                                                   {},
                                                                   {HeightType::int32, 1.0, 0.0},
                                                                   {},
                                                                   0.1}),
                                              cost);
    std::cout << "largest degree on a flat sea: " << degree << "\n";
    EXPECT_LE(degree, 96U);
  }
}

TEST(Simplify, KeepsDegreesComfortableAroundSpikesAndInThinRasters) {
  const HeightEncoding whole{HeightType::int32, 1.0, 0.0};
  const auto spikes = [](int x, int y) { return x % 50 == 25 && y % 50 == 25 ? 1000.0 : 0.0; };
  for (const auto& spec :
       {oracle::RasterSpec{"spikes", 150, 150, spikes, {}, whole, {}, 0.1},
        oracle::RasterSpec{"thin", 3000, 2, [](int, int) { return 0.0; }, {}, whole, {}, 0.1},
        oracle::RasterSpec{"void sea",
                           150,
                           150,
                           spikes,
                           [](int x, int y) { return x % 50 > 20 && y % 50 > 20; },
                           whole,
                           {},
                           0.1}}) {
    const std::size_t degree = largest_degree(oracle::make_raster(spec), CostModel::kError);
    std::cout << "largest degree, " << spec.name << ": " << degree << "\n";
    EXPECT_LE(degree, 128U);
  }
}

}  // namespace
}  // namespace ptin
