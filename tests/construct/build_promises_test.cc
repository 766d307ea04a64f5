// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters built through a tree of tiles into a store, and the promises of engine/DESIGN.md, section 2.8,
// held against their samples.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/store_promises.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

constexpr double kNodata = -2147483648.0;

/// The raster that the terrain's samples came from; a grid unit is a ground unit.
oracle::RasterFile file_of(const TestTerrain& terrain) {
  oracle::RasterFile file;
  const GridPoint last = terrain.samples.back().position;
  file.columns = last.x + 1;
  file.rows = last.y + 1;
  file.step = 1.0;
  file.nodata = kNodata;
  file.type = terrain.tile.units.heights.type == HeightType::int32 ? GDT_Int32 : GDT_Float32;
  file.value = [&terrain, columns = file.columns, rows = file.rows](int column, int row) {
    const auto i = static_cast<std::size_t>((rows - 1 - row) * columns + column);
    return terrain.samples[i].has_height ? terrain.samples[i].code : kNodata;
  };
  return file;
}

bool can_be_a_file(const TestTerrain& terrain) {
  return terrain.samples.front().position == GridPoint{0, 0} &&
         terrain.tile.units.heights.step == 1.0 && terrain.name != "the range of int32";
}

void expect_promises(const TestTerrain& terrain, std::int64_t tile, CostModel cost) {
  SCOPED_TRACE(terrain.name + ", tiles of " + std::to_string(tile));
  const oracle::WrittenRaster raster(file_of(terrain));
  const oracle::ScratchFolder folder;
  BuildOptions options;
  options.tile = tile;
  options.cost = cost;
  build({raster.path()}, folder.file("out.ptin"), options, {});
  EXPECT_EQ(oracle::check_store(terrain, Terrain::open(folder.file("out.ptin"))), "");
}

TEST(BuildOverTiles, KeepsItsPromisesOnNastyRasters) {
  for (const auto& make : test::some_of(oracle::nasty_rasters())) {
    const TestTerrain terrain = make();
    if (can_be_a_file(terrain)) {
      expect_promises(terrain, 8, CostModel::kError);
    }
  }
}

TEST(BuildOverTiles, KeepsItsPromisesOnLakes) {
  for (const auto& make : test::some_of(oracle::lakes())) {
    expect_promises(make(), 16, CostModel::kError);
  }
}

TEST(BuildOverTiles, KeepsItsPromisesOnRandomRasters) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    TestTerrain terrain = oracle::random_terrain(seed, 300);
    const bool is_raster = terrain.tile.samples_fill_grid && terrain.slope == 0.1;
    if (is_raster && can_be_a_file(terrain)) {
      expect_promises(terrain, 4 + static_cast<std::int64_t>(seed % 9),
                      static_cast<CostModel>(seed % 3));
    }
  }
}

}  // namespace
}  // namespace ptin
