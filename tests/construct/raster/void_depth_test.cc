// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/void_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"

namespace ptin {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct Mask {
  std::int64_t width = 0, height = 0;
  std::vector<std::uint8_t> valid;
};

/// Rows from the north, as one looks at a map: '#' is a sample with a height, '.' a void.
Mask drawn(const std::vector<std::string>& rows) {
  Mask mask;
  mask.height = static_cast<std::int64_t>(rows.size());
  mask.width = static_cast<std::int64_t>(rows[0].size());
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (char c : *row) {
      mask.valid.push_back(c == '#');
    }
  }
  return mask;
}

MaskWindow whole(const Mask& m) { return {m.valid, m.width, m.height, 0, 0, m.width, m.height}; }

GroundStepOfRow uniform(double x, double y) {
  return [x, y](std::int64_t) { return GroundStep{x, y}; };
}

std::vector<float> depths(const MaskWindow& mask, const GroundStepOfRow& steps,
                          int cut_off = kVoidDepthCutOff) {
  std::vector<float> depth(static_cast<std::size_t>(mask.inner_width * mask.inner_height));
  void_depth(mask, steps, cut_off, depth);
  return depth;
}

/// The definition, sample by sample. `slack` on either side of the cut-off is left undecided (NaN).
std::vector<double> brute_force(const Mask& m, const GroundStepOfRow& steps, int cut_off) {
  std::vector<double> result;
  for (std::int64_t y = 0; y < m.height; ++y) {
    GroundStep step = steps(y);
    const double larger = std::max(step.x, step.y);
    step = {std::max(step.x, larger / 64), std::max(step.y, larger / 64)};
    for (std::int64_t x = 0; x < m.width; ++x) {
      double best = std::numeric_limits<double>::infinity();
      for (std::int64_t v = 0; v < m.height; ++v) {
        for (std::int64_t u = 0; u < m.width; ++u) {
          if ((m.valid[v * m.width + u] != 0) != (m.valid[y * m.width + x] != 0)) {
            const double dx = static_cast<double>(u - x) * step.x;
            const double dy = static_cast<double>(v - y) * step.y;
            best = std::min(best, std::sqrt(dx * dx + dy * dy));
          }
        }
      }
      const double limit = cut_off * std::min(step.x, step.y);
      if (std::abs(best - limit) < 1e-6 * limit && step.x != step.y) {
        best = std::numeric_limits<double>::quiet_NaN();
      } else if (best > limit) {
        best = std::numeric_limits<double>::infinity();
      }
      result.push_back(best);
    }
  }
  return result;
}

TEST(VoidDepth, IsTheDistanceToTheNearestSampleOfTheOtherClass) {
  const Mask m = drawn({"####",  //
                        "#..#",  //
                        "####"});
  const float r = std::sqrt(2.0F);
  EXPECT_EQ(depths(whole(m), uniform(1, 1)),
            (std::vector<float>{r, 1, 1, r, 1, 1, 1, 1, r, 1, 1, r}));
}

TEST(VoidDepth, IsInGroundUnits) {
  const Mask m = drawn({"#...",  //
                        "####"});
  // Along the row 30 a step, along the column 2; the south-western sample's nearest is on the
  // diagonal.
  const float diagonal = std::sqrt(904.0F);
  EXPECT_EQ(depths(whole(m), uniform(30, 2)), (std::vector<float>{diagonal, 2, 2, 2, 30, 2, 2, 2}));
}

TEST(VoidDepth, UsesTheStepsOfTheSamplesOwnRow) {
  const Mask m = drawn({".##",  //
                        ".##",  //
                        ".##"});
  const auto steps = [](std::int64_t y) { return GroundStep{10.0 + static_cast<double>(y), 10.0}; };
  EXPECT_EQ(depths(whole(m), steps), (std::vector<float>{10, 10, 20, 11, 11, 22, 12, 12, 24}));
}

TEST(VoidDepth, IsInfiniteWhereThereIsOneClass) {
  for (std::uint8_t value : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{255}}) {
    Mask m{5, 4, std::vector<std::uint8_t>(20, value)};
    EXPECT_EQ(depths(whole(m), uniform(1, 1)), std::vector<float>(20, kInfinite));
  }
}

TEST(VoidDepth, IsInfiniteBeyondTheCutOff) {
  Mask m{12, 1, std::vector<std::uint8_t>(12, 1)};
  m.valid[0] = 0;
  const auto d = depths(whole(m), uniform(3, 3), 5);
  for (int x = 1; x < 12; ++x) {
    EXPECT_EQ(d[x], x <= 5 ? static_cast<float>(3 * x) : kInfinite) << x;
  }
}

TEST(VoidDepth, IsNeverZeroOnTheRowOfAPole) {
  const Mask m = drawn({"#.#", "###"});
  for (float d : depths(whole(m), uniform(0, 100))) {
    EXPECT_GT(d, 0);
  }
}

TEST(VoidDepth, RefusesWhatIsNoWindow) {
  const Mask m = drawn({"##", "#."});
  MaskWindow w = whole(m);
  w.inner_x = 1;
  std::vector<float> depth(4);
  EXPECT_THROW(void_depth(w, uniform(1, 1), 64, depth), Error);
  EXPECT_THROW(void_depth(whole(m), uniform(1, 1), 0, depth), Error);
  EXPECT_THROW(void_depth(whole(m), uniform(1, 1), 5000, depth), Error);
  EXPECT_THROW(void_depth(whole(m), uniform(0, 0), 64, depth), Error);
  EXPECT_THROW(void_depth(whole(m), uniform(NAN, 1), 64, depth), Error);
  EXPECT_THROW(void_depth(whole(m), uniform(-1, 1), 64, depth), Error);
}

TEST(VoidDepth, HoldsItsBoundsAtTheLargestCutOffAndRatio) {
  Mask m{9000, 2, std::vector<std::uint8_t>(18000, 1)};
  m.valid[0] = m.valid[8999] = 0;
  const auto d = depths(whole(m), uniform(64, 1), 4096);
  EXPECT_EQ(d[1], 64.0F);
  EXPECT_EQ(d[64], 4096.0F);
  EXPECT_EQ(d[65], kInfinite);
  EXPECT_EQ(d[8998], 64.0F);
  const auto tall = depths(whole(m), uniform(1, 64), 4096);
  EXPECT_EQ(tall[4096], 4096.0F);
  EXPECT_EQ(tall[4097], kInfinite);
}

Mask arbitrary_mask(int max_side) {
  Mask m;
  m.width = *rc::gen::inRange(1, max_side);
  m.height = *rc::gen::inRange(1, max_side);
  const int percent = *rc::gen::element(1, 5, 30, 50, 90, 99);
  const auto n = static_cast<std::size_t>(m.width * m.height);
  for (int v : *rc::gen::container<std::vector<int>>(n, rc::gen::inRange(0, 100))) {
    m.valid.push_back(v % 100 < percent);
  }
  return m;
}

GroundStepOfRow arbitrary_steps() {
  const int kind = *rc::gen::inRange(0, 3);
  const double x = *rc::gen::element(1.0, 30.0, 0.3, 7.7), y = *rc::gen::element(1.0, 30.0, 92.6);
  if (kind == 0) {
    return uniform(x, x);
  }
  if (kind == 1) {
    return uniform(x, y);
  }
  return [x, y](std::int64_t row) {
    return GroundStep{x * std::cos(0.02 * static_cast<double>(row)), y};
  };
}

RC_GTEST_PROP(VoidDepth, AgreesWithBruteForce, ()) {
  const Mask m = arbitrary_mask(24);
  const auto steps = arbitrary_steps();
  const int cut_off = *rc::gen::element(1, 2, 5, 64);
  const auto found = depths(whole(m), steps, cut_off);
  const auto expected = brute_force(m, steps, cut_off);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::isnan(expected[i])) {
      continue;
    }
    if (std::isinf(expected[i])) {
      RC_ASSERT(std::isinf(found[i]));
    } else {
      RC_ASSERT(std::abs(found[i] - expected[i]) <= 2e-7 * expected[i]);
    }
  }
}

RC_GTEST_PROP(VoidDepth, OfATileWithItsMarginIsThatOfTheWhole, ()) {
  const Mask m = arbitrary_mask(40);
  const auto steps = arbitrary_steps();
  const int cut_off = *rc::gen::element(1, 3, 7);
  const auto all = depths(whole(m), steps, cut_off);
  const std::int64_t x0 = *rc::gen::inRange<std::int64_t>(0, m.width);
  const std::int64_t x1 = *rc::gen::inRange<std::int64_t>(x0, m.width) + 1;
  const std::int64_t y0 = *rc::gen::inRange<std::int64_t>(0, m.height);
  const std::int64_t y1 = *rc::gen::inRange<std::int64_t>(y0, m.height) + 1;
  const std::int64_t left = std::max<std::int64_t>(x0 - cut_off, 0);
  const std::int64_t right = std::min(x1 + cut_off, m.width);
  const std::int64_t low = std::max<std::int64_t>(y0 - cut_off, 0);
  const std::int64_t high = std::min(y1 + cut_off, m.height);
  Mask part{right - left, high - low, {}};
  for (std::int64_t y = low; y < high; ++y) {
    for (std::int64_t x = left; x < right; ++x) {
      part.valid.push_back(m.valid[y * m.width + x]);
    }
  }
  const MaskWindow window{part.valid, part.width, part.height, x0 - left,
                          y0 - low,   x1 - x0,    y1 - y0};
  const auto tile = depths(
      window, [&](std::int64_t y) { return steps(y + low); }, cut_off);
  std::size_t i = 0;
  for (std::int64_t y = y0; y < y1; ++y) {
    for (std::int64_t x = x0; x < x1; ++x) {
      RC_ASSERT(tile[i++] == all[y * m.width + x]);
    }
  }
}

}  // namespace
}  // namespace ptin
