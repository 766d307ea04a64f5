// SPDX-License-Identifier: GPL-3.0-or-later
//
// Residuals against rationals, on stars of every size that the grid holds.
#include "engine/construct/measure/fan_measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/mesh/collapse.h"
#include "engine/query/select/coarsest.h"
#include "tests/construct/star_fixture.h"

namespace ptin {
namespace {

using oracle::Bound;
using oracle::Gap;
using oracle::kFloat;
using oracle::kInt;
using oracle::noise;
using oracle::StarTile;

constexpr double kNever = std::numeric_limits<double>::infinity();

double small_int(GridPoint p) { return noise(p) % 500; }
double any_int(GridPoint p) { return static_cast<double>(noise(p)) - 2147483648.0; }
double fraction(GridPoint p) { return static_cast<double>(static_cast<float>(noise(p)) * 1e-5F); }

struct FanCase {
  std::int32_t extent;
  HeightEncoding heights;
  double (*code)(GridPoint);
};
/// Narrow, at the edge of narrow, wide, and the whole grid; exact and rounded.
const FanCase kCases[] = {
    {12, kInt, small_int},        {1000, kInt, small_int},        {1000, kInt, any_int},
    {300, kFloat, fraction},      {(1 << 25) - 9, kInt, any_int}, {(1 << 25) - 9, kFloat, fraction},
    {1 << 27, kInt, small_int},   {1 << 28, kFloat, fraction},    {kGridMax, kInt, any_int},
    {kGridMax, kFloat, fraction},
};

/// Calls visit(tile, star) for every vertex of some tiles of each case.
template <class Visit>
void for_each_star(std::uint64_t seeds, const Visit& visit) {
  for (const FanCase& c : kCases) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      const StarTile made(seed, c.extent, {}, c.heights, c.code);
      StarSamples s;
      for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
        oracle::gather_all(made.tile, u, s);
        visit(made.tile, s);
      }
    }
  }
}

/// The largest exact gap of the samples is at most `bound`; returns the largest rough one.
long double expect_bounded(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                           double bound) {
  const Bound exact(bound, 1.0);
  long double largest = 0.0L;
  for (const Sample& sample : s.source) {
    bool found = false;
    for (std::size_t i = 0; i < fan.triangles(); ++i) {
      const oracle::Corners t = oracle::fan_corners(tile, s, fan, i);
      if (oracle::in_closed(t, sample.position)) {
        const Gap gap = Gap::of_sample(t, sample.position, tile.units.heights.code(sample.height));
        EXPECT_FALSE(gap.exceeds(exact)) << "residual " << gap.rough() << " bound " << bound;
        largest = std::max(largest, gap.rough());
        found = true;
      }
    }
    EXPECT_TRUE(found) << "a sample of the star lies outside of the fan";
  }
  return largest;
}

TEST(MakeFan, AgreesWithCanCollapse) {
  std::size_t allowed = 0, refused = 0, wide = 0;
  FanFrame fan;
  for_each_star(12, [&](const Tile& tile, const StarSamples& s) {
    wide += s.is_wide() ? 1 : 0;
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      const bool can = can_collapse(tile.tin, s.star, j);
      ASSERT_EQ(make_fan(s, j, fan), can);
      (can ? allowed : refused) += 1;
    }
  });
  EXPECT_GT(allowed, 1000U);
  EXPECT_GT(refused, 1000U);
  EXPECT_GT(wide, 100U);
}

TEST(MakeFan, SeesTheAreaOfANeedleAcrossTheGrid) {
  // Twice the area of (w, a, b) is 1: the difference of two products near 2^58, which doubles take
  // for equal.
  constexpr std::int32_t kHalf = 1 << 29;
  CoarsestTin star;
  for (const GridPoint p :
       {GridPoint{0, 0}, {kHalf, kHalf - 1}, {kHalf + 1, kHalf}, {0, kGridMax}, {1 << 20, kHalf}}) {
    star.vertices.push_back({p, 0, 1});
  }
  star.triangles = {{{4, 0, 1}, 0}, {{4, 1, 2}, 0}, {{4, 2, 3}, 0}, {{4, 3, 0}, 0}};
  Tile tile;
  tile.units.heights = kInt;
  tile.tin = mesh_of(star, "star");
  start_tile(tile, nullptr);
  StarSamples s;
  FanFrame fan;
  gather_star(tile, 4, s);
  EXPECT_TRUE(s.is_wide());
  std::size_t allowed = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_EQ(make_fan(s, j, fan), can_collapse(tile.tin, s.star, j));
    allowed += can_collapse(tile.tin, s.star, j) ? 1 : 0;
  }
  EXPECT_GE(allowed, 2U);
}

TEST(MakeFan, NamesTheStarTriangleThatEachFanTriangleReplaces) {
  FanFrame fan;
  for_each_star(3, [&](const Tile& tile, const StarSamples& s) {
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      Tin tin = tile.tin;
      collapse(tin, s.star, j);
      std::size_t kept = 0;
      for (const TriangleId t : s.star.triangles) {
        kept += tin.is_alive(t) ? 1 : 0;
      }
      ASSERT_EQ(fan.triangles(), kept);
      for (const std::uint32_t i : fan.star_triangle) {
        ASSERT_TRUE(tin.is_alive(s.star.triangles[i]));
      }
    }
  });
}

TEST(LargestResidual, IsNeverBelowTheTrueOneAndNotFarAbove) {
  FanFrame fan;
  for_each_star(4, [&](const Tile& tile, const StarSamples& s) {
    const double bound = residual_bound(s, tile.units);
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (make_fan(s, j, fan)) {
        const double worst = largest_residual(s, fan, 0, s.x.size(), kNever);
        const double certified = scaled_up(worst) + bound;
        const long double exact = expect_bounded(tile, s, fan, certified);
        EXPECT_LE(certified, exact * (1.0L + 1e-14L) + 2.0L * bound);
      }
    }
  });
}

TEST(CertifiedResidual, IsNeverBelowTheTrueOneEvenWhereItIsTakenForWhole) {
  FanFrame fan;
  StarSamples s;
  std::size_t whole = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::int32_t extent = seed % 2 == 0 ? 8 : 6000;
    const StarTile made(seed, extent, {}, kInt, [](GridPoint p) { return noise(p) % 40; });
    for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
      oracle::gather_all(made.tile, u, s);
      for (std::size_t j = 0; j < s.star.degree(); ++j) {
        if (!make_fan(s, j, fan)) {
          continue;
        }
        const double worst = largest_residual(s, fan, 0, s.x.size(), kNever);
        const double certified = certified_residual(worst, s, made.tile.units);
        (void)expect_bounded(made.tile, s, fan, certified);
        whole += certified > 0.0 && certified == std::floor(certified) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(whole, 50U);
}

TEST(LargestResidual, NeedsNoBoundBesideItWhereArithmeticIsExact) {
  FanFrame fan;
  StarSamples s;
  std::size_t exact = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const StarTile made(seed, 200, {5, 7}, kInt, small_int);
    for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
      gather_star(made.tile, u, s);
      exact += residual_bound(s, made.tile.units) == 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(exact, 400U);
}

TEST(LargestResidual, StopsAboveTheLimitOrNotAtAll) {
  FanFrame fan;
  for_each_star(2, [&](const Tile&, const StarSamples& s) {
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      const double all = largest_residual(s, fan, 0, s.x.size(), kNever);
      for (const double limit : {0.0, all / 2, all, 2 * all}) {
        const double some = largest_residual(s, fan, 0, s.x.size(), limit);
        EXPECT_LE(some, all);
        EXPECT_TRUE(some > limit || some == all);
      }
    }
  });
}

TEST(LargestResidual, IsThatOfItsParts) {
  FanFrame fan;
  for_each_star(2, [&](const Tile&, const StarSamples& s) {
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      double parts = 0.0;
      for (std::size_t k = 0; k < s.x.size(); k += kSampleLanes) {
        parts = std::max(parts, largest_residual(s, fan, k, k + kSampleLanes, kNever));
      }
      EXPECT_EQ(parts, largest_residual(s, fan, 0, s.x.size(), kNever));
    }
  });
}

TEST(LargestResidual, OfWideStarsIsThatOfNarrowOnesOfTheSameShape) {
  FanFrame narrow_fan, wide_fan;
  StarSamples narrow, wide;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const StarTile small(seed, 500, {}, kInt, small_int);
    Tile large = small.tile;
    constexpr std::int32_t kFactor = 1 << 21;
    for (Vertex& v : large.tin.vertices) {
      v.position = {v.position.x * kFactor, v.position.y * kFactor};
    }
    for (TriangleId t = 0; t < large.tin.triangles.size(); ++t) {
      for (Sample& sample : large.samples.samples(large.carried[t].samples)) {
        sample.position = {sample.position.x * kFactor, sample.position.y * kFactor};
      }
    }
    for (VertexId u = 0; u < large.tin.vertices.size(); ++u) {
      gather_star(small.tile, u, narrow);
      gather_star(large, u, wide);
      for (std::size_t j = 0; j < narrow.star.degree(); ++j) {
        const bool allowed = make_fan(narrow, j, narrow_fan);
        ASSERT_EQ(make_fan(wide, j, wide_fan), allowed);
        if (allowed) {
          EXPECT_EQ(largest_residual(wide, wide_fan, 0, wide.x.size(), kNever),
                    largest_residual(narrow, narrow_fan, 0, narrow.x.size(), kNever));
        }
      }
    }
  }
}

TEST(LargestResidual, DoesNotDependOnWhereTheStarStands) {
  FanFrame first_fan, second_fan;
  StarSamples first, second;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const StarTile here(seed, 400, {}, kInt, small_int);
    Tile there = here.tile;
    const std::int32_t shift = kGridMax - 400;
    for (Vertex& v : there.tin.vertices) {
      v.position = {v.position.x + shift, v.position.y + shift};
    }
    for (TriangleId t = 0; t < there.tin.triangles.size(); ++t) {
      for (Sample& sample : there.samples.samples(there.carried[t].samples)) {
        sample.position = {sample.position.x + shift, sample.position.y + shift};
      }
    }
    for (VertexId u = 0; u < there.tin.vertices.size(); ++u) {
      gather_star(here.tile, u, first);
      gather_star(there, u, second);
      for (std::size_t j = 0; j < first.star.degree(); ++j) {
        ASSERT_EQ(make_fan(first, j, first_fan), make_fan(second, j, second_fan));
        if (make_fan(first, j, first_fan)) {
          EXPECT_EQ(largest_residual(first, first_fan, 0, first.x.size(), kNever),
                    largest_residual(second, second_fan, 0, second.x.size(), kNever));
        }
      }
    }
  }
}

TEST(AssignSamples, FindsATriangleThatHoldsEachSampleAndItsResidual) {
  FanFrame fan;
  std::vector<double> triangle, residual;
  for_each_star(4, [&](const Tile& tile, const StarSamples& s) {
    const double bound = residual_bound(s, tile.units);
    for (std::size_t j = 0; j < s.star.degree(); ++j) {
      if (!make_fan(s, j, fan)) {
        continue;
      }
      assign_samples(s, fan, triangle, residual);
      ASSERT_EQ(triangle.size(), s.x.size());
      for (std::size_t k = 0; k < s.source.size(); ++k) {
        const auto i = static_cast<std::size_t>(triangle[k]);
        ASSERT_LT(i, fan.triangles());
        const oracle::Corners t = oracle::fan_corners(tile, s, fan, i);
        ASSERT_TRUE(oracle::in_closed(t, s.source[k].position));
        const Gap gap =
            Gap::of_sample(t, s.source[k].position, tile.units.heights.code(s.source[k].height));
        EXPECT_FALSE(gap.exceeds(Bound(scaled_up(residual[k]) + bound, 1.0)));
      }
      const double largest = largest_residual(s, fan, 0, s.x.size(), kNever);
      EXPECT_NEAR(*std::max_element(residual.begin(), residual.end()), largest,
                  1e-14 * largest + 2 * bound);
    }
  });
}

TEST(GatherStar, PutsTheVertexFirstAndPadsWithIt) {
  for_each_star(1, [&](const Tile& tile, const StarSamples& s) {
    ASSERT_EQ(s.x.size() % kSampleLanes, 0U);
    ASSERT_EQ(s.source.size(), s.count);
    EXPECT_EQ(s.source[0].position, tile.tin.position(s.star.center));
    std::size_t expected = 1;
    for (const TriangleId t : s.star.triangles) {
      expected += tile.carried[t].samples.count;
    }
    EXPECT_EQ(s.count, expected);
    for (std::size_t k = s.count; k < s.x.size(); ++k) {
      EXPECT_TRUE(s.x[k] == 0.0 && s.y[k] == 0.0 && s.z[k] == 0.0);
    }
    for (std::size_t k = 0; k < s.count; ++k) {
      EXPECT_EQ(s.x[k], s.source[k].position.x - tile.tin.position(s.star.center).x);
      EXPECT_EQ(s.y[k], s.source[k].position.y - tile.tin.position(s.star.center).y);
    }
  });
}

/// A plane, but for one sample that is off by `off`.
void expect_zero_decided(std::int32_t extent, const HeightEncoding& heights, double slope,
                         double off) {
  FanFrame fan;
  StarSamples s;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const auto plane = [&](GridPoint p) { return slope * p.x - 2 * slope * p.y; };
    StarTile made(seed, extent, {}, heights, plane);
    for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
      oracle::gather_all(made.tile, u, s);
      for (std::size_t j = 0; j < s.star.degree(); ++j) {
        if (!make_fan(s, j, fan)) {
          continue;
        }
        EXPECT_TRUE(all_residuals_zero(made.tile, s, fan));
        for (std::size_t k = 0; k < s.source.size(); k += 3) {
          StarSamples moved = s;
          const double code = heights.code(moved.source[k].height);
          moved.source[k].height = heights.bits(code + off);
          EXPECT_FALSE(all_residuals_zero(made.tile, moved, fan));
        }
      }
    }
  }
}

TEST(AllResidualsZero, DecidesPlanesExactly) {
  expect_zero_decided(1000, kInt, 3.0, 1.0);
  expect_zero_decided(1000, kInt, 100000.0, -1.0);
  expect_zero_decided(1000, kFloat, 0.125, 0.125);
  expect_zero_decided(1000, kFloat, 0x1p-30, 0x1p-30);
  expect_zero_decided(kGridMax, kInt, 0.0, 1.0);
  expect_zero_decided(1 << 23, kFloat, 1.0 / 2, 16.0);
}

TEST(AllResidualsZero, DoesNotTrustCodesThatSpanTooManyBits) {
  const auto code = [](GridPoint p) { return p.x % 2 == 0 ? 0x1p50 : 0x1p-50; };
  const StarTile made(1, 100, {}, kFloat, code);
  StarSamples s;
  FanFrame fan;
  for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
    oracle::gather_all(made.tile, u, s);
    const bool mixed = std::any_of(s.source.begin(), s.source.end(),
                                   [&](const Sample& a) { return a.height != s.source[0].height; });
    for (std::size_t j = 0; mixed && j < s.star.degree(); ++j) {
      if (make_fan(s, j, fan)) {
        EXPECT_FALSE(all_residuals_zero(made.tile, s, fan));
      }
    }
  }
}

}  // namespace
}  // namespace ptin
