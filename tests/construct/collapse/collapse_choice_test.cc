// SPDX-License-Identifier: GPL-3.0-or-later
//
// The chosen neighbour against all of them, measured in rationals.
#include "engine/construct/collapse/collapse_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "engine/mesh/collapse.h"
#include "tests/construct/star_fixture.h"

namespace ptin {
namespace {

using oracle::kFloat;
using oracle::kInt;
using oracle::noise;
using oracle::StarTile;

/// The largest gap of the star's samples to the fan into link[j]; nothing when it is not allowed.
std::optional<long double> error_into(const Tile& tile, const StarSamples& s, std::size_t j) {
  FanFrame fan;
  if (!can_collapse(tile.tin, s.star, j) || !make_fan(s, j, fan)) {
    return std::nullopt;
  }
  long double worst = 0.0L;
  for (const Sample& sample : s.source) {
    for (std::size_t i = 0; i < fan.triangles(); ++i) {
      const oracle::Corners t = oracle::fan_corners(tile, s, fan, i);
      if (oracle::in_closed(t, sample.position)) {
        worst = std::max(worst, oracle::Gap::of_sample(t, sample.position,
                                                       tile.units.heights.code(sample.height))
                                    .rough());
      }
    }
  }
  return worst;
}

void expect_best_choices(const Tile& tile) {
  CollapseChooser chooser;
  StarSamples s;
  for (VertexId u = 0; u < tile.tin.vertices.size(); ++u) {
    gather_star(tile, u, s);
    const CollapseChoice choice = chooser.choose(tile, nullptr, s);
    oracle::gather_all(tile, u, s);
    std::optional<long double> least;
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      const auto error = error_into(tile, s, j);
      least = error && (!least || *error < *least) ? error : least;
    }
    ASSERT_EQ(least.has_value(), choice.j != CollapseChoice::kNoNeighbour);
    if (!least) {
      continue;
    }
    const auto slack = static_cast<long double>(residual_bound(s, tile.units));
    const long double chosen = error_into(tile, s, choice.j).value();
    EXPECT_LE(chosen, *least * (1 + 1e-14L) + 4 * slack);
    EXPECT_GE(choice.error, chosen * (1 - 1e-15L));
    EXPECT_LE(choice.error, *least * (1 + 1e-14L) + 4 * slack);
  }
}

TEST(CollapseChooser, TakesTheNeighbourWithTheLeastError) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto small = [](GridPoint p) { return static_cast<double>(noise(p) % 100); };
    const auto fraction = [](GridPoint p) { return static_cast<double>(noise(p) % 1000) / 7.0; };
    expect_best_choices(StarTile(seed, 60, {}, kInt, small).tile);
    expect_best_choices(StarTile(seed, 5000, {3, 4}, kFloat, fraction).tile);
    expect_best_choices(StarTile(seed, kGridMax, {}, kInt, small).tile);
    expect_best_choices(StarTile(seed, 60, {}, kInt, small, 24, 0).tile);
  }
}

TEST(CollapseChooser, TakesTheSmallestKeyAmongEquals) {
  const StarTile flat(3, 50, {}, kInt, [](GridPoint) { return 5.0; });
  CollapseChooser chooser;
  StarSamples s;
  for (VertexId u = 0; u < flat.tile.tin.vertices.size(); ++u) {
    gather_star(flat.tile, u, s);
    const CollapseChoice choice = chooser.choose(flat.tile, nullptr, s);
    VertexKey least = kNoVertexKey;
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (can_collapse(flat.tile.tin, s.star, j)) {
        least = std::min(least, key_of(flat.tile.tin.position(s.star.link[j])));
      }
    }
    ASSERT_EQ(choice.j == CollapseChoice::kNoNeighbour, least == kNoVertexKey);
    if (least != kNoVertexKey) {
      EXPECT_EQ(key_of(flat.tile.tin.position(s.star.link[choice.j])), least);
      EXPECT_EQ(choice.error, 0.0);
    }
  }
}

TEST(CollapseChooser, AvoidsCrowdedNeighboursWhileThereAreOthers) {
  StarTile made(4, 60, {}, kInt, [](GridPoint p) { return static_cast<double>(noise(p) % 9); });
  Tile& tile = made.tile;
  CollapseChooser chooser;
  StarSamples s;
  std::size_t avoided = 0, taken = 0;
  for (VertexId u = 0; u < tile.tin.vertices.size(); ++u) {
    gather_star(tile, u, s);
    const CollapseChoice first = chooser.choose(tile, nullptr, s);
    if (first.j == CollapseChoice::kNoNeighbour) {
      continue;
    }
    VertexState& w = tile.vertex_state[s.star.link[first.j]];
    const std::uint16_t degree = w.degree;
    w.degree = kComfortableDegree + 5;
    const CollapseChoice second = chooser.choose(tile, nullptr, s);
    w.degree = degree;
    ASSERT_NE(second.j, CollapseChoice::kNoNeighbour);
    (second.j == first.j ? taken : avoided) += 1;
    if (second.j == first.j) {  // then it is the only one
      for (std::size_t j = 0; j < s.star.degree(); ++j) {
        EXPECT_TRUE(j == first.j || !can_collapse(tile.tin, s.star, j));
      }
    }
  }
  EXPECT_GT(avoided, 10U);
}

/// The only neighbour with a height is crowded, the others would put a void corner on a surface.
TEST(CollapseChooser, TakesACrowdedNeighbourWhenTheOthersAreVoid) {
  const auto valid = [](int x, int y) { return x + y >= 2 || (x == 1 && y == 0); };
  oracle::TestTerrain terrain = oracle::make_raster(
      {"corner", 4, 4, [](int x, int y) { return 1.0 * x * y; }, valid, kInt, {}, 0.1});
  CollapseChooser chooser;
  StarSamples s;
  std::size_t looked_at = 0;
  for (VertexId u = 0; u < terrain.full.vertices.size(); ++u) {
    gather_star(terrain.tile, u, s);
    if (chooser.choose(terrain.tile, nullptr, s).j == CollapseChoice::kNoNeighbour) {
      continue;
    }
    for (VertexId v = 0; v < terrain.full.vertices.size(); ++v) {
      terrain.tile.vertex_state[v].degree =
          static_cast<std::uint16_t>(terrain.full.has_height[v] != 0 ? kComfortableDegree + 5 : 3);
    }
    gather_star(terrain.tile, u, s);
    EXPECT_NE(chooser.choose(terrain.tile, nullptr, s).j, CollapseChoice::kNoNeighbour)
        << terrain.full.position(u).x << " " << terrain.full.position(u).y;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 4U);
}

}  // namespace
}  // namespace ptin
