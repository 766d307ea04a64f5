// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/plane_blocks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/collapse/simplify.h"
#include "engine/geometry/orient.h"
#include "tests/construct/exact_oracle.h"
#include "tests/construct/star_fixture.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::RasterSpec;
using oracle::TestTerrain;

std::vector<RasterSpec> block_specs() {
  std::vector<RasterSpec> all(4);
  all[0].name = "hills";
  all[0].code = [](int x, int y) {
    return std::floor(40.0 * std::sin(0.11 * x) * std::cos(0.07 * y)) + (x * 7 + y * 13) % 3;
  };
  all[1].name = "noise";
  all[1].code = [](int x, int y) { return static_cast<double>(oracle::noise({x, y}) % 1000); };
  all[2].name = "a sea";
  all[2].code = [hills = all[0].code](int x, int y) { return std::max(5.0, hills(x, y)); };
  all[3].name = "far from the origin";
  all[3].code = all[0].code;
  all[3].origin = {kGridMax - 200, kGridMax - 200};
  for (RasterSpec& spec : all) {
    spec.width = 133;  // a square of 128 and what is left of others
    spec.height = 75;
  }
  return all;
}

/// Whether a sample counts in fan triangle `i`: inside or on an edge that the collapse makes.
bool is_counted(const StarSamples& s, const FanFrame& fan, std::size_t i, const oracle::Corners& t,
                GridPoint p) {
  if (!oracle::in_closed(t, p) || orient(t[1].position, t[2].position, p) == 0) {
    return false;
  }
  const bool on_first = orient(t[0].position, t[1].position, p) == 0;
  const bool on_last = orient(t[2].position, t[0].position, p) == 0;
  const bool closed = s.star.closed;
  return !(closed && i == 0 && on_first) && !(closed && i + 1 == fan.triangles() && on_last);
}

double largest_of_all(const TestTerrain& terrain, const StarSamples& s, const FanFrame& fan) {
  long double worst = 0.0L;
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const oracle::Corners t = oracle::fan_corners(terrain.tile, s, fan, i);
    for (const oracle::PlainSample& sample : terrain.samples) {
      if (is_counted(s, fan, i, t, sample.position)) {
        worst = std::max(worst, oracle::Gap::of_sample(t, sample.position, sample.code).rough());
      }
    }
  }
  return static_cast<double>(worst);
}

/// Every collapse that the mesh of the terrain allows, over the samples of `blocks`.
void expect_as_brute_force(const TestTerrain& terrain, const PlaneBlocks& blocks) {
  StarSamples s;
  FanFrame fan;
  const Tin& tin = terrain.tile.tin;
  int fans = 0;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    if (tin.vertices[v].triangle == kNone) {
      continue;
    }
    gather_star(terrain.tile, v, s);
    const PlaneBlocks::Centre u{
        tin.position(v), terrain.tile.units.heights.code(tin.vertices[v].height), s.star.closed};
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      ++fans;
      const double worst = largest_of_all(terrain, s, fan);
      EXPECT_NEAR(blocks.largest_residual(fan, u, 0.0), worst, 1e-12 * worst) << terrain.name;
      EXPECT_NEAR(blocks.largest_residual(fan, u, 0.7 * worst), worst, 1e-12 * worst);
      EXPECT_EQ(blocks.largest_residual(fan, u, worst + 1.0), worst + 1.0);
    }
  }
  EXPECT_GT(fans, 50);
}

TEST(PlaneBlocks, FindTheLargestResidualOfEveryFan) {
  for (const RasterSpec& spec : block_specs()) {
    for (const std::uint64_t keep : test::some_of<std::uint64_t>({700, 40})) {
      TestTerrain terrain = make_raster(spec);
      const GridBox box{terrain.samples.front().position.x, terrain.samples.front().position.y,
                        terrain.samples.back().position.x, terrain.samples.back().position.y};
      const PlaneBlocks blocks(terrain.tile, box);
      SimplifyOptions options;
      options.keep = keep;
      simplify(terrain.tile, *terrain.surface, options);
      expect_as_brute_force(terrain, blocks);
    }
  }
}

TEST(PlaneBlocks, BoundTheHeightsOfTheLeaf) {
  const TestTerrain terrain = make_raster(block_specs()[1]);
  const GridBox box{terrain.samples.front().position.x, terrain.samples.front().position.y,
                    terrain.samples.back().position.x, terrain.samples.back().position.y};
  const PlaneBlocks blocks(terrain.tile, box);
  for (const double code : {0.0, 480.0, 1200.0}) {
    double largest = 0.0;
    for (const oracle::PlainSample& sample : terrain.samples) {
      largest = std::max(largest, std::abs(sample.code - code));
    }
    EXPECT_EQ(blocks.largest_z({{0, 0}, code, true}), largest);
  }
}

}  // namespace
}  // namespace ptin
