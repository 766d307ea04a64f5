// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/grid_stars.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/collapse/collapse_choice.h"
#include "tests/construct/star_fixture.h"
#include "tests/construct/test_terrain.h"

namespace ptin {
namespace {

using oracle::RasterSpec;
using oracle::TestTerrain;

RasterSpec noisy_raster(const char* name, std::uint32_t heights) {
  RasterSpec spec;
  spec.name = name;
  spec.width = 61;
  spec.height = 47;
  spec.code = [heights](int x, int y) {
    return static_cast<double>(oracle::noise({x, y}) % heights);
  };
  return spec;
}

std::vector<RasterSpec> grid_specs() {
  std::vector<RasterSpec> all{noisy_raster("steps", 3),   noisy_raster("rough", 1000),
                              noisy_raster("a plain", 1), noisy_raster("fractions", 1000),
                              noisy_raster("voids", 7),   noisy_raster("far from the origin", 5)};
  all[3].heights = oracle::kFloat;
  all[3].code = [](int x, int y) {
    return static_cast<float>(oracle::noise({x, y}) % 1000) / 7.0F;
  };
  all[4].valid = [](int x, int y) { return std::hypot(x - 20, y - 20) > 6; };
  all[5].origin = {kGridMax - 100, kGridMax - 100};
  return all;
}

/// The number of vertices for which the table tells; each must be what the chooser says.
std::size_t compare(const TestTerrain& terrain) {
  const GridBox box{terrain.samples.front().position.x, terrain.samples.front().position.y,
                    terrain.samples.back().position.x, terrain.samples.back().position.y};
  const GridStars grid(terrain.tile, box);
  CollapseChooser chooser;
  StarSamples s;
  std::size_t told = 0;
  for (VertexId u = 0; u < terrain.tile.tin.vertices.size(); ++u) {
    const auto choice = grid.choose(u);
    if (!choice) {
      continue;
    }
    ++told;
    gather_star(terrain.tile, u, s);
    const CollapseChoice expected = chooser.choose(terrain.tile, terrain.surface.get(), s);
    EXPECT_NEAR(choice->error, expected.error, 1e-12 * expected.error) << terrain.name << ' ' << u;
    EXPECT_NE(expected.j, CollapseChoice::kNoNeighbour);
    if (terrain.tile.units.exact_codes) {  // else two errors that differ by rounding may be swapped
      EXPECT_EQ(choice->w, s.star.link[expected.j]) << terrain.name << ' ' << u;
    }
  }
  return told;
}

TEST(GridStars, ChooseAsTheChooserDoes) {
  for (const RasterSpec& spec : grid_specs()) {
    const TestTerrain terrain = make_raster(spec);
    const std::size_t inner = 59 * 45;
    const std::size_t told = compare(terrain);
    if (spec.valid) {
      EXPECT_GT(told, inner / 2);
      EXPECT_LT(told, inner);
    } else if (terrain.tile.units.exact_codes) {
      EXPECT_EQ(told, inner) << spec.name;
    } else {
      EXPECT_GT(told, inner * 9 / 10) << spec.name;
    }
  }
}

}  // namespace
}  // namespace ptin
