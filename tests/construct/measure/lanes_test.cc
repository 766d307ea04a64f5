// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every set of lanes gives the same bits, from single operations to whole simplifications.
#include "engine/construct/measure/lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/collapse/collapse_choice.h"
#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/void_measure.h"
#include "tests/construct/star_fixture.h"
#include "tests/construct/test_terrain.h"

namespace ptin {
namespace {

using oracle::kFloat;
using oracle::kInt;
using oracle::noise;
using oracle::StarTile;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Numbers as bits, so that zeros differ by their signs; a NaN is a NaN, whichever operand of a sum
/// it was.
using Bits = std::vector<std::uint64_t>;
void add(Bits& bits, double v) {
  bits.push_back(std::bit_cast<std::uint64_t>(std::isnan(v) ? kNan : v));
}

/// The results that `work` adds with each set of lanes that the processor has, the plain one first.
template <class Work>
std::vector<Bits> with_every_set(const Work& work) {
  std::vector<Bits> all;
  for (const LaneSet set : {LaneSet::kPlain, LaneSet::kAvx2, LaneSet::kAvx512}) {
    if (set <= lanes_of_processor()) {
      use_lanes(set);
      EXPECT_EQ(lanes_in_use(), set);
      work(all.emplace_back());
    }
  }
  use_lanes(lanes_of_processor());
  return all;
}

void expect_alike(const std::vector<Bits>& all) {
  for (const Bits& bits : all) {
    EXPECT_EQ(bits, all.front());
  }
}

TEST(UseLanes, TakesNoMoreThanTheProcessorHas) {
  use_lanes(LaneSet::kAvx512);
  EXPECT_EQ(lanes_in_use(), lanes_of_processor());
}

constexpr std::size_t kOperations = 10;

/// Each operation on the eight numbers at `a` and at `b`.
struct EachOperation {
  template <class Lanes>
  PTIN_LANES static void run(const double* a, const double* b, double* out) noexcept {
    const Lanes x = load_lanes<Lanes>(a);
    const Lanes y = load_lanes<Lanes>(b);
    store_lanes(out, x + y);
    store_lanes(out + 8, x - y);
    store_lanes(out + 16, x * y);
    store_lanes(out + 24, 1.0 / x);
    store_lanes(out + 32, smaller(x, y));
    store_lanes(out + 40, larger(x, y));
    store_lanes(out + 48, where_below(x, b[0], -x, y));
    store_lanes(out + 56, magnitude(x));
    store_lanes(out + 64, b[1] * x - b[2]);
    store_lanes(out + 72, all_lanes<Lanes>(largest_lane(x)));
  }
};

/// The operations by single numbers.
void by_single_numbers(const double* a, const double* b, double* out) {
  std::array<double, 8> left{};
  std::copy_n(a, 8, left.begin());
  for (std::size_t half = 4; half > 0; half /= 2) {
    for (std::size_t i = 0; i < half; ++i) {
      left[i] = left[i + half] > left[i] ? left[i + half] : left[i];
    }
  }
  for (std::size_t i = 0; i < 8; ++i) {
    const std::array<double, kOperations> of_lane = {a[i] + b[i],
                                                     a[i] - b[i],
                                                     a[i] * b[i],
                                                     1.0 / a[i],
                                                     b[i] < a[i] ? b[i] : a[i],
                                                     b[i] > a[i] ? b[i] : a[i],
                                                     a[i] < b[0] ? -a[i] : b[i],
                                                     a[i] < 0.0 ? -a[i] : a[i],
                                                     b[1] * a[i] - b[2],
                                                     left[0]};
    for (std::size_t k = 0; k < kOperations; ++k) {
      out[8 * k + i] = of_lane[k];
    }
  }
}

RC_GTEST_PROP(InLanes, GivesTheBitsOfSingleNumbersWithEverySet, ()) {
  const double kUsual[] = {0.0,       -0.0,       1.0,  -1.0,      0.1,
                           kInfinite, -kInfinite, kNan, 0x1p-1074, 0x1p52};
  const auto number = rc::gen::oneOf(rc::gen::elementOf(std::vector<double>(kUsual, kUsual + 10)),
                                     rc::gen::arbitrary<double>());
  const auto a = *rc::gen::container<std::vector<double>>(8, number);
  const auto b = *rc::gen::container<std::vector<double>>(8, number);
  std::array<double, 8 * kOperations> out{};
  const auto add_all = [&out](Bits& bits) {
    std::for_each(out.begin(), out.end(), [&](double v) { add(bits, v); });
  };
  const std::vector<Bits> all = with_every_set([&](Bits& bits) {
    in_lanes<EachOperation>(a.data(), b.data(), out.data());
    add_all(bits);
  });
  by_single_numbers(a.data(), b.data(), out.data());
  Bits expected;
  add_all(expected);
  for (const Bits& bits : all) {
    RC_ASSERT(bits == expected);
  }
}

/// Measures of each fan of a star.
void measure_fans(const StarSamples& s, Bits& bits) {
  FanFrame fan;
  std::vector<double> triangle, residual;
  for (std::size_t j = 0; j < s.star.degree(); ++j) {
    if (!make_fan(s, j, fan)) {
      continue;
    }
    const double all = largest_residual(s, fan, 0, s.x.size(), kInfinite);
    add(bits, all);
    add(bits, largest_residual(s, fan, 0, s.x.size(), all / 2));
    assign_samples(s, fan, triangle, residual);
    for (std::size_t k = 0; k < s.x.size(); ++k) {
      add(bits, triangle[k]);
      add(bits, residual[k]);
    }
  }
}

TEST(FanMeasure, GivesTheSameBitsWithEverySetOfLanes) {
  const auto whole = [](GridPoint p) { return noise(p) % 500; };
  const auto tied = [](GridPoint p) { return noise(p) % 2; };
  const auto fraction = [](GridPoint p) {
    return static_cast<double>(static_cast<float>(noise(p)) * 1e-5F);
  };
  StarSamples s;
  for (int samples = 1; samples <= 17; ++samples) {
    for (const auto& [heights, code] :
         {std::pair<HeightEncoding, std::function<double(GridPoint)>>{kInt, whole},
          {kInt, tied},
          {kFloat, fraction}}) {
      const auto seed = static_cast<std::uint64_t>(samples);
      const StarTile made(seed, samples % 2 == 0 ? 9 : 4000, {}, heights, code, 6, samples);
      expect_alike(with_every_set([&](Bits& bits) {
        for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
          oracle::gather_all(made.tile, u, s);
          measure_fans(s, bits);
        }
      }));
    }
  }
}

/// No file holds such heights; that they are measured alike shows that nothing depends on them.
TEST(FanMeasure, GivesTheSameBitsOfHeightsThatAreNoNumbers) {
  const StarTile made(3, 1000, {}, kInt, [](GridPoint p) { return noise(p) % 500; });
  StarSamples s;
  expect_alike(with_every_set([&](Bits& bits) {
    for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
      oracle::gather_all(made.tile, u, s);
      for (std::size_t k = u % 3; k < s.z.size(); k += 3) {
        s.z[k] = k % 2 == 0 ? kNan : (k % 4 == 1 ? -kInfinite : -0.0);
      }
      measure_fans(s, bits);
    }
  }));
}

TEST(CollapseChooser, ChoosesAlikeWithEverySetOfLanes) {
  CollapseChooser chooser;
  StarSamples s;
  for (const std::uint32_t heights : {2U, 1000U}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto code = [=](GridPoint p) { return noise(p) % heights; };
      const StarTile made(seed, seed % 2 == 0 ? 12 : 5000, {}, kInt, code);
      expect_alike(with_every_set([&](Bits& bits) {
        for (VertexId u = 0; u < made.tile.tin.vertices.size(); ++u) {
          gather_star(made.tile, u, s);
          const CollapseChoice choice = chooser.choose(made.tile, nullptr, s);
          bits.push_back(choice.j);
          add(bits, choice.error);
        }
      }));
    }
  }
}

TEST(Simplify, MakesTheSameRecordsWithEverySetOfLanesAmidVoids) {
  oracle::RasterSpec spec;
  spec.name = "holes";
  spec.width = spec.height = 25;
  spec.slope = 1.0;
  spec.code = [](int x, int y) {
    return std::floor(9 * std::sin(x / 7.0) + 7 * std::cos(y / 5.0));
  };
  spec.valid = [](int x, int y) { return (x % 7 != 3 || y % 5 != 2) && x + y / 3 != 20; };
  std::vector<std::vector<VertexSplit>> records;
  with_every_set([&](Bits&) {
    records.push_back(oracle::simplified(oracle::make_raster(spec)).tile.records);
  });
  EXPECT_GT(records.front().size(), 400U);
  for (const std::vector<VertexSplit>& made : records) {
    EXPECT_EQ(made, records.front());
  }
}

}  // namespace
}  // namespace ptin
