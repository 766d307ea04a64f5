// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_tile.h"

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace ptin {
namespace {

using Bytes = std::vector<std::byte>;

Bytes packed(const FloorTile& tile) {
  Bytes bytes;
  append_floor_tile(tile, bytes);
  return bytes;
}

/// The tile of some bytes, and what is wrong with them.
std::pair<FloorTile, std::string> read(Bytes bytes, std::uint32_t width, std::uint32_t height) {
  const std::size_t size = bytes.size();
  bytes.resize(size + kFloorTileTail, std::byte{0xFF});
  FloorTile tile;
  const char* const fault = read_floor_tile({bytes.data(), size}, width, height, tile);
  return {std::move(tile), fault != nullptr ? fault : ""};
}

bool is_void(const FloorTile& tile, std::size_t i) {
  return !tile.is_void.empty() && tile.is_void[i] != 0;
}

/// What was packed comes back, but for the heights of void samples; and packs to the same bytes.
void expect_back(const FloorTile& tile, const std::string& what) {
  const Bytes bytes = packed(tile);
  const auto [back, fault] = read(bytes, tile.width, tile.height);
  ASSERT_EQ(fault, "") << what;
  ASSERT_EQ(back.heights.size(), tile.samples()) << what;
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    ASSERT_EQ(is_void(back, i), is_void(tile, i)) << what << " " << i;
    if (!is_void(tile, i)) {
      ASSERT_EQ(back.heights[i], tile.heights[i]) << what << " " << i;
    }
  }
  EXPECT_EQ(back.lone, tile.lone) << what;
  EXPECT_EQ(packed(back), bytes) << what;
}

FloorTile made(std::uint32_t width, std::uint32_t height,
               const std::function<OrderedHeight(std::uint32_t, std::uint32_t)>& at) {
  FloorTile tile;
  tile.width = width;
  tile.height = height;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) tile.heights.push_back(at(x, y));
  }
  return tile;
}

TEST(FloorTile, HeightsOfAllKindsComeBack) {
  std::mt19937 random(1);
  for (const auto& [width, height] :
       {std::pair{33U, 33U}, {1U, 1U}, {1U, 65U}, {65U, 65U}, {8U, 4U}, {9U, 5U}, {33U, 2U}}) {
    const std::string size = std::to_string(width) + " x " + std::to_string(height);
    expect_back(made(width, height, [](auto, auto) { return 7U; }), "flat " + size);
    expect_back(made(width, height, [](auto x, auto y) { return 1000 + 3 * x - 2 * y; }),
                "plane " + size);
    expect_back(
        made(width, height, [&](auto, auto) { return static_cast<OrderedHeight>(random()); }),
        "noise " + size);
    expect_back(made(width, height, [](auto x, auto y) { return (x + y) % 2 == 0 ? 0U : ~0U; }),
                "extremes " + size);
    expect_back(made(width, height,
                     [](auto x, auto y) {
                       return static_cast<OrderedHeight>(5000 + 400 * std::sin(x * 0.2) * y);
                     }),
                "hills " + size);
  }
}

TEST(FloorTile, VoidsOfAllKindsComeBack) {
  std::mt19937 random(2);
  for (const double share : {0.0, 0.01, 0.2, 0.9, 1.0}) {
    for (const bool is_block : {false, true}) {
      FloorTile tile = made(33, 30, [](auto x, auto y) { return 1000 + x * y; });
      tile.is_void.resize(tile.samples());
      for (std::size_t i = 0; i < tile.samples(); ++i) {
        tile.is_void[i] =
            is_block ? static_cast<double>(i) >= (1 - share) * static_cast<double>(tile.samples())
                     : std::uniform_real_distribution<>(0, 1)(random) < share;
      }
      for (std::size_t i = 0; i < tile.samples(); ++i) {
        if (tile.is_void[i] == 0) {
          continue;
        }
        if (random() % 5 == 0) {
          tile.lone.push_back(
              {static_cast<std::uint16_t>(i), static_cast<std::uint32_t>(random())});
        }
        tile.heights[i] = static_cast<std::uint32_t>(random());  // of no account
      }
      expect_back(tile, "share " + std::to_string(share));
    }
  }
}

TEST(FloorTile, WhatStandsInVoidSamplesIsOfNoAccount) {
  FloorTile tile = made(33, 33, [](auto x, auto y) { return 100 * x + y; });
  tile.is_void.assign(tile.samples(), 0);
  for (const std::size_t i : {0U, 1U, 33U, 500U, 501U, 534U, 1088U}) tile.is_void[i] = 1;
  const Bytes bytes = packed(tile);
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    if (tile.is_void[i] != 0) tile.heights[i] = 0xDEADBEEF;
  }
  EXPECT_EQ(packed(tile), bytes);
}

TEST(FloorTile, SmoothFloorIsSmall) {
  const FloorTile flat = made(33, 33, [](auto, auto) { return 1234U; });
  // Voids, the first height, and a width a block.
  EXPECT_EQ(packed(flat).size(), (2 + 32 + 6 * 5 * 9 + 7) / 8U);
}

TEST(FloorTile, DamagedBytesAreRefusedOrAnotherTile) {
  std::mt19937 random(3);
  FloorTile tile = made(33, 33, [&](auto x, auto y) { return 1000 + x * y + random() % 16; });
  tile.is_void.assign(tile.samples(), 0);
  for (std::size_t i = 300; i < 360; ++i) tile.is_void[i] = 1;
  tile.lone = {{310, 5}, {350, 6}};
  const Bytes bytes = packed(tile);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_NE(
        read({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}, 33, 33).second,
        "");
  }
  std::size_t refused = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    Bytes flipped = bytes;
    flipped[bit / 8] ^= std::byte{1} << (bit % 8);
    const auto [other, fault] = read(flipped, 33, 33);
    if (!fault.empty()) {
      ++refused;
    } else {
      EXPECT_FALSE(packed(other) == bytes) << bit;
    }
  }
  EXPECT_GT(refused, 100U);
  Bytes longer = bytes;
  longer.push_back({});
  EXPECT_EQ(read(longer, 33, 33).second,
            "a tile of heights is followed by bytes that are not its own");
}

}  // namespace
}  // namespace ptin
