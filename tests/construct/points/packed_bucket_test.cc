// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/packed_bucket.h"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

/// Packs and unpacks; returns the bytes that took.
std::size_t expect_same(const std::vector<GridVertex>& points) {
  GridBox box;
  for (const GridVertex& p : points) {
    box = united(box, p.position);
  }
  std::vector<std::byte> bytes;
  pack_bucket(points, box, bytes);
  const std::size_t size = bytes.size();
  EXPECT_LE(size, 16 * points.size() + 10);
  bytes.resize(size + kUnpackSlack, std::byte{0xA5});
  std::vector<GridVertex> back(points.size());
  unpack_bucket(std::span(bytes).first(size), box, back);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(back[i].position, points[i].position) << i;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back[i].height),
              std::bit_cast<std::uint64_t>(points[i].height))
        << points[i].height;
  }
  return size;
}

TEST(PackedBucket, TakesWhatPointsDifferBy) {
  std::vector<GridVertex> points;
  for (int i = 0; i < 1024; ++i) {
    points.push_back({{1'000'000'000 + i % 32, 5'000 + i / 32}, 3000.0 + i % 16});
  }
  EXPECT_EQ(expect_same(points), 10U + 1024U * (5 + 5 + 4) / 8);
  for (GridVertex& p : points) {
    p.height = 1.0;
  }
  EXPECT_EQ(expect_same(points), 10U + 1024U * 10 / 8);
}

TEST(PackedBucket, KeepsEveryBitOfHeights) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  const std::vector<double> odd = {0.0,  -0.0, 1.5,   -1.5,  0.1,  -0.1,   kTiny,
                                   -7.0, 9e15, -9e15, 1e300, 1e17, -1e300, 3.0};
  for (const double a : odd) {
    expect_same({{{3, 4}, a}});
    for (const double b : odd) {
      expect_same({{{0, 0}, a}, {{(1 << 30) - 1, 1 << 30}, b}});
    }
  }
}

RC_GTEST_PROP(PackedBucket, GivesBackWhatItGot, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const auto count = *rc::gen::inRange<std::size_t>(1, 300);
  const auto bits_x = *rc::gen::inRange(0, 31), bits_y = *rc::gen::inRange(0, 31);
  const auto kind = *rc::gen::inRange(0, 3);
  const auto bits_z = *rc::gen::inRange(0, 53);
  std::vector<GridVertex> points(count);
  for (GridVertex& p : points) {
    p.position.x = static_cast<std::int32_t>(random() & ((std::uint64_t{1} << bits_x) - 1));
    p.position.y = static_cast<std::int32_t>(random() & ((std::uint64_t{1} << bits_y) - 1));
    const double z = static_cast<double>(random() & ((std::uint64_t{1} << bits_z) - 1)) - 1000.0;
    p.height =
        kind == 0 ? z : (kind == 1 ? static_cast<double>(static_cast<float>(z * 0.1)) : z * 0.1);
  }
  expect_same(points);
}

TEST(PackedBucket, ReadsNothingBehindDamagedBytes) {
  std::vector<GridVertex> points(100);
  for (int i = 0; i < 100; ++i) {
    points[static_cast<std::size_t>(i)] = {{i * 1000, i * 77}, i * 0.37};
  }
  const GridBox box{0, 0, 99'000, 99 * 77};
  std::vector<std::byte> bytes;
  pack_bucket(points, box, bytes);
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    cut.resize(size + kUnpackSlack);
    unpack_bucket(std::span(cut).first(size), box, points);  // under a sanitizer
    bytes[size] = std::byte{0xFF};
    std::vector<std::byte> changed = bytes;
    changed.resize(bytes.size() + kUnpackSlack);
    unpack_bucket(std::span(changed).first(bytes.size()), box, points);
  }
}

}  // namespace
}  // namespace ptin
