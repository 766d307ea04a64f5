// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/sorted_samples.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "engine/query/shape/tiler.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::TestFolder;

StoreFacts facts_over(const GridBox& bounds) {
  StoreFacts facts;
  facts.bounds = bounds;
  facts.heights.type = HeightType::int32;
  facts.heights.step = 0.25;
  facts.heights.offset = 10.0;
  return facts;
}

std::vector<std::array<double, 3>> sorted(const std::vector<SourceSample>& samples) {
  std::vector<std::array<double, 3>> rows;
  for (const SourceSample& s : samples)
    rows.push_back({static_cast<double>(s.x), static_cast<double>(s.y), s.height});
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// Samples all over the box, many on one place, and what is to come of them: in each box those
/// places, at the mean of their codes.
void expect_like_a_map(const GridBox& bounds, std::uint64_t memory, int samples) {
  const TestFolder folder;
  const StoreFacts facts = facts_over(bounds);
  SortedSamples found(facts, {FileLayer::system(), folder.path().string(), memory});
  std::mt19937 random(7);
  const auto between = [&](std::int64_t low, std::int64_t high) {
    return static_cast<std::int32_t>(
        std::uniform_int_distribution<std::int64_t>(low, high)(random));
  };
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<double>> heights;
  for (int i = 0; i < samples; ++i) {
    const bool crowded = i % 3 == 0;  // in a corner
    const GridPoint p{
        between(bounds.min_x, crowded ? std::min(bounds.min_x + 40, bounds.max_x) : bounds.max_x),
        between(bounds.min_y, crowded ? std::min(bounds.min_y + 40, bounds.max_y) : bounds.max_y)};
    const double height = 10.0 + 0.25 * between(-99, 99);
    found.add(p, height);
    heights[{p.x, p.y}].push_back(height);
  }
  found.sort({});
  EXPECT_EQ(folder.names().size(), 0U) << "its files have no names";
  const auto expect_same_in = [&](const GridBox& box) {
    std::vector<SourceSample> expected;
    for (const auto& [place, all] : heights) {
      if (!contains(box, GridPoint{place.first, place.second})) continue;
      double codes = 0.0;
      for (const double height : all) codes += (height - 10.0) / 0.25;
      const double mean = std::nearbyint(codes / static_cast<double>(all.size()));
      expected.push_back({place.first, place.second, 10.0 + 0.25 * mean, false});
    }
    EXPECT_EQ(found.count(box), expected.size());
    EXPECT_EQ(sorted(found.read(box)), sorted(expected));
  };
  expect_same_in(bounds);
  expect_same_in(divided(divided(bounds)[1])[0]);
  for (int i = 0; i < 20; ++i) {
    const std::array<std::int32_t, 2> x{between(bounds.min_x, bounds.max_x),
                                        between(bounds.min_x, bounds.max_x)};
    const std::array<std::int32_t, 2> y{between(bounds.min_y, bounds.max_y),
                                        between(bounds.min_y, bounds.max_y)};
    expect_same_in(
        {std::min(x[0], x[1]), std::min(y[0], y[1]), std::max(x[0], x[1]), std::max(y[0], y[1])});
  }
}

constexpr GridBox kAll{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
constexpr GridBox kSome{-50, 20, 900, 450};

TEST(SortedSamples, AreThoseOfAMapInMemory) {
  expect_like_a_map(kSome, 100'000'000, 20'000);
  expect_like_a_map(kAll, 100'000'000, 20'000);
}

TEST(SortedSamples, AreThoseOfAMapOnDisk) {
  expect_like_a_map(kSome, 1, 40'000);
  expect_like_a_map(kAll, 1, 40'000);
}

TEST(SortedSamples, MayBeNoneOrOnePlace) {
  expect_like_a_map({5, 5, 5, 5}, 1, 10);
  expect_like_a_map(kSome, 1, 0);
}

TEST(SortedSamples, CanBeStopped) {
  const TestFolder folder;
  const StoreFacts facts = facts_over(kSome);
  SortedSamples samples(facts, {FileLayer::system(), folder.path().string(), 1});
  samples.add({0, 100}, 1.0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(samples.sort(stop.get_token()), Error);
}

}  // namespace
}  // namespace ptin::tools
