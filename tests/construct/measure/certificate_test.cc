// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blocks of samples (sample_blocks.h) certify what their samples would: stars with blocks in them,
// against every sample of each block.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/void_measure.h"
#include "tests/construct/star_fixture.h"

namespace ptin {
namespace {

using oracle::Bound;
using oracle::Gap;
using oracle::kInt;
using oracle::StarTile;

/// Fills the triangles around `u` with at most `most` blocks, some void where `voids`; returns
/// their number.
std::size_t add_blocks(Tile& tile, VertexId u, bool voids, std::size_t most,
                       std::mt19937_64& random) {
  Star star;
  walk_star(tile.tin, u, star);
  std::size_t added = 0;
  for (const TriangleId t : star.triangles) {
    const oracle::Corners c = oracle::corners_of(tile.tin, t, kInt);
    std::vector<Sample> list;
    for (int attempt = 0; attempt < 60 && added + list.size() < most; ++attempt) {
      const auto log = static_cast<std::uint16_t>(1 + random() % 5);
      const std::int32_t side = 1 << log;
      const auto place = [&] { return static_cast<std::int32_t>(random() % 128) / side * side; };
      const GridPoint p{place(), place()};
      const GridPoint q{p.x + side - 1, p.y + side - 1};
      if (oracle::in_closed(c, p) && oracle::in_closed(c, q) && oracle::in_closed(c, {p.x, q.y}) &&
          oracle::in_closed(c, {q.x, p.y})) {
        const bool is_void = voids && random() % 2 == 0;
        const auto reach = static_cast<float>(1 + random() % 9);
        list.push_back(
            {p, kInt.bits(static_cast<double>(random() % 50)), is_void ? -reach : reach, log});
      }
    }
    tile.carried[t].samples = tile.samples.take(static_cast<std::uint32_t>(list.size()));
    std::copy(list.begin(), list.end(), tile.samples.samples(tile.carried[t].samples).begin());
    tile.carried[t].holds_heights = tile.carried[t].holds_voids = true;
    added += list.size();
  }
  return added;
}

template <class Visit>
void for_each_sample_of(const Sample& block, const Visit& visit) {
  const std::int32_t side = std::int32_t{1} << block.side_log;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      visit(GridPoint{block.position.x + x, block.position.y + y});
    }
  }
}

/// What the samples of all blocks cost in the fan, one by one.
struct OneByOne {
  long double residual = 0.0L;  ///< In closed surface triangles.
  double charge = 0.0;
};

OneByOne measure_one_by_one(const Tile& tile, const StarSamples& s, const FanFrame& fan) {
  OneByOne found;
  for (const Sample& block : s.source) {
    for_each_sample_of(block, [&](GridPoint p) {
      bool in_closed = false, in_void = false;
      for (std::size_t i = 0; i < fan.triangles(); ++i) {
        const oracle::Corners c = oracle::fan_corners(tile, s, fan, i);
        if (!oracle::in_closed(c, p)) {
          continue;
        }
        if (!oracle::is_surface(tile.tin, s.star.triangles[fan.star_triangle[i]])) {
          in_void = true;
          continue;
        }
        in_closed = true;
        if (block.reach > 0.0F) {
          found.residual =
              std::max(found.residual, Gap::of_sample(c, p, kInt.code(block.height)).rough());
        }
      }
      if (block.reach > 0.0F ? !in_closed : !in_void) {
        found.charge = std::max(found.charge, std::abs(static_cast<double>(block.reach)));
      }
    });
  }
  return found;
}

/// Calls visit(tile, star) for stars with blocks, with random classes where `voids`.
template <class Visit>
void for_each_star_with_blocks(bool voids, std::size_t most, const Visit& visit) {
  std::size_t blocks = 0;
  for (std::uint64_t seed = 0; seed < (voids ? 1200U : 100U); ++seed) {
    std::mt19937_64 random(seed);
    StarTile made(
        seed, 127, {}, kInt, [&](GridPoint) { return static_cast<double>(random() % 50); }, 6, 0);
    Tile& tile = made.tile;
    tile.has_voids = voids;
    tile.units.void_slope_code = 1.0;
    for (TriangleClass& c : tile.tin.classes) {
      c = voids && random() % 2 == 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
    }
    StarSamples s;
    for (VertexId u = 0; u < tile.tin.vertices.size(); ++u) {
      blocks += add_blocks(tile, u, voids, most, random);
      tile.vertex_state[u].reach = 1.0F;
      oracle::gather_all(tile, u, s);
      visit(tile, s);
    }
  }
  EXPECT_GT(blocks, 300U);
}

TEST(SampleBlocks, BoundTheResidualOfEachOfTheirSamples) {
  FanFrame fan;
  std::size_t inside = 0;
  for_each_star_with_blocks(false, 6, [&](const Tile& tile, const StarSamples& s) {
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (make_fan(s, j, fan)) {
        const double corners =
            largest_residual(s, fan, 0, s.x.size(), std::numeric_limits<double>::infinity());
        const double bound = std::max(corners, straddling_residual(s, fan));
        const OneByOne found = measure_one_by_one(tile, s, fan);
        EXPECT_GE(scaled_up(bound) + residual_bound(s, tile.units), found.residual);
        inside += found.residual > corners * (1 + 1e-9L) ? 1 : 0;
      }
    }
  });
  EXPECT_GT(inside, 10U);  // where the corners alone would not have done
}

TEST(SampleBlocks, AreChargedForEachSampleOfTheWrongClass) {
  FanFrame fan;
  std::size_t charged = 0;
  for_each_star_with_blocks(true, 1, [&](const Tile& tile, const StarSamples& s) {
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      const VoidMeasure measure = measure_with_voids(tile, s, fan, nullptr);
      const OneByOne found = measure_one_by_one(tile, s, fan);
      ASSERT_TRUE(measure.allowed);
      EXPECT_GE(measure.error, found.charge);
      EXPECT_GE(scaled_up(measure.deviation) + residual_bound(s, tile.units), found.residual);
      charged += found.charge > 0.0 ? 1 : 0;
    }
  });
  EXPECT_GT(charged, 100U);
}

TEST(JoinIntoBlocks, KeepsEverySampleWithItsHeightAndNoSmallerReach) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<Sample> samples;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        if (random() % 200 != 0) {
          const bool is_void = x > 20 + y / 8;
          const float reach = 1.0F + 0.03F * static_cast<float>((x * y) % 7);
          samples.push_back(
              {{x + 3, y + 5}, is_void ? 0U : kInt.bits(x / 9), is_void ? -reach : reach, 0});
        }
      }
    }
    std::shuffle(samples.begin(), samples.end(), random);
    std::vector<Sample> joined = samples;
    join_into_blocks(joined);
    EXPECT_LT(joined.size(), samples.size() / 2);
    std::vector<Sample> apart;
    for (const Sample& block : joined) {
      EXPECT_EQ(block.position.x % (1 << block.side_log), 0);
      EXPECT_EQ(block.position.y % (1 << block.side_log), 0);
      for_each_sample_of(block, [&](GridPoint p) {
        apart.push_back({p, block.height, block.reach, 0});
      });
    }
    ASSERT_EQ(apart.size(), samples.size());
    const auto by_key = [](const Sample& a, const Sample& b) {
      return key_of(a.position) < key_of(b.position);
    };
    std::sort(apart.begin(), apart.end(), by_key);
    std::sort(samples.begin(), samples.end(), by_key);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      ASSERT_EQ(apart[i].position, samples[i].position);
      ASSERT_EQ(apart[i].height, samples[i].height);
      ASSERT_EQ(std::signbit(apart[i].reach), std::signbit(samples[i].reach));
      ASSERT_GE(std::abs(apart[i].reach), std::abs(samples[i].reach));
    }
  }
}

}  // namespace
}  // namespace ptin
