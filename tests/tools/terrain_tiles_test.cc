// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tiles for Cesium there are, and the limits on making one.
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <stop_token>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

TEST(TerrainTiles, AreThereWhereLayerJsonSays) {
  const TestFolder folder;
  for (const std::string& path : tiled_terrains(folder, 1)) {
    const Tiled tiled(path);
    EXPECT_EQ(tiled.tiles.pyramid().looked_at(), tiled.finest())
        << "of a small terrain all is known";
    const nlohmann::json layer = tiled.tiles.layer_json("1");
    ASSERT_EQ(layer.at("available").size(), static_cast<std::size_t>(tiled.finest()) + 1);
    EXPECT_EQ(layer.at("maxzoom"), tiled.finest());
    std::set<std::pair<std::int64_t, std::int64_t>> below;
    for (int z = tiled.finest(); z >= 0; --z) {
      std::set<std::pair<std::int64_t, std::int64_t>> there;
      for (const TileNumber& t : listed(layer, z)) there.insert({t.x, t.y});
      const std::int64_t columns = std::int64_t{2} << z;
      std::set<std::pair<std::int64_t, std::int64_t>> looked_at{{0, 0}, {columns - 1, 0}};
      for (const auto& [x, y] : there) {
        for (std::int64_t dx = -2; dx <= 2; ++dx) {
          for (std::int64_t dy = -2; dy <= 2; ++dy) looked_at.insert({x + dx, y + dy});
        }
      }
      for (const auto& [x, y] : looked_at) {
        EXPECT_EQ(tiled.tiles.has(z, x, y), there.contains({x, y}));
        EXPECT_EQ(tiled.tiles.tile({z, x, y, true, limits_of()}).has_value(),
                  there.contains({x, y}));
      }
      for (const auto& [x, y] : there) {
        const double area = area_of({z, x, y}, tiled.read(z, x, y));
        EXPECT_TRUE(area != 0.0 || below.contains({x, y})) << path << z << "/" << x << "/" << y;
      }
      below.clear();
      for (const auto& [x, y] : there) below.insert({x / 2, y / 2});
    }
  }
}

TEST(TerrainTiles, OfLevelZeroAreTheFlatGlobe) {
  const TestFolder folder;
  const Tiled tiled(built(folder, "coast_257.tif"));
  for (const std::int64_t x : {0, 1}) {
    const ReadTerrain tile = tiled.read(0, x, 0);
    EXPECT_NEAR(area_of({0, x, 0}, tile), 180.0 * 180.0, 1e-9);
    for (std::size_t i = 0; i < tile.u.size(); ++i) EXPECT_EQ(tile.height(i), 0.0);
  }
}

TEST(TerrainTiles, AnyNumbersAreAnswered) {
  const TestFolder folder;
  const Tiled tiled(built_with_holes(folder));
  std::mt19937_64 random(11);
  for (int i = 0; i < 3000; ++i) {
    const auto z = static_cast<std::int64_t>(random() % 40) - 5;
    std::int64_t x = static_cast<std::int64_t>(random());
    std::int64_t y = static_cast<std::int64_t>(random());
    if (i % 2 == 0 && z >= 0 && z < 30) {
      x = static_cast<std::int64_t>(random() % (std::uint64_t{2} << z));
      y = static_cast<std::int64_t>(random() % (std::uint64_t{1} << z));
    }
    const auto bytes = tiled.tiles.tile({z, x, y, true, limits_of()});
    EXPECT_EQ(bytes.has_value(), tiled.tiles.has(z, x, y));
    if (bytes) static_cast<void>(read_terrain_tile(bytes->bytes));
  }
  for (const std::int64_t v : {INT64_MIN, INT64_MAX, std::int64_t{-1}}) {
    EXPECT_FALSE(tiled.tiles.tile({v, 0, 0, true, limits_of()}).has_value());
    EXPECT_FALSE(tiled.tiles.tile({5, v, 0, true, limits_of()}).has_value());
    EXPECT_FALSE(tiled.tiles.tile({5, 0, v, true, limits_of()}).has_value());
  }
}

TEST(TerrainTiles, KeepToTheirLimits) {
  const TestFolder folder;
  const Tiled tiled(built(folder, "mountains_257.tif"));
  const int z = tiled.finest();
  const TileNumber t = listed(tiled.tiles.layer_json("1"), z).front();
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(code_of([&] {
              static_cast<void>(tiled.tiles.tile(
                  {z, t.x, t.y, true, limits_of(kTileMemory, stopped.get_token())}));
            }),
            ErrorCode::cancelled);
  EXPECT_EQ(code_of([&] {
              static_cast<void>(tiled.tiles.tile({z, t.x, t.y, true, limits_of(20'000)}));
            }),
            ErrorCode::resource_exhausted);
  EXPECT_EQ(code_of([&] {
              const TerrainTiles other(tiled.terrain, tiled.crs, {},
                                       limits_of(kTileMemory, stopped.get_token()));
            }),
            ErrorCode::cancelled);
  TerrainTilesOptions few;
  few.most_vertices = 50;
  const TerrainTiles small(tiled.terrain, tiled.crs, few, limits_of());
  EXPECT_EQ(code_of([&] {
              static_cast<void>(small.tile({z, t.x, t.y, true, limits_of()}));
            }),
            ErrorCode::resource_exhausted);
}

TEST(TerrainTiles, OfWhichNobodyLookedAtAllAreThoseBelow) {
  const TestFolder folder;
  TerrainTilesOptions options;
  options.coverage_triangles = 2000;
  const Tiled tiled(built(folder, "coast_257.tif"), options);
  const Tiled known(built(folder, "coast_257.tif", "known.ptin"));
  const int looked_at = tiled.tiles.pyramid().looked_at();
  EXPECT_GE(looked_at, tiled.tiles.first_level());
  EXPECT_LT(looked_at, tiled.finest());
  const nlohmann::json layer = tiled.tiles.layer_json("1");
  std::size_t empty = 0;
  for (int z = 0; z <= tiled.finest(); ++z) {
    std::set<std::pair<std::int64_t, std::int64_t>> there;
    for (const TileNumber& t : listed(layer, z)) {
      there.insert({t.x, t.y});
      EXPECT_TRUE(tiled.tiles.has(z, t.x, t.y));
      const ReadTerrain tile = tiled.read(z, t.x, t.y);
      if (area_of(t, tile) == 0.0) ++empty;
    }
    for (const TileNumber& t : listed(known.tiles.layer_json("1"), z)) {
      EXPECT_TRUE(there.contains({t.x, t.y}) || z > looked_at);
      if (there.contains({t.x, t.y})) {
        EXPECT_EQ(tiled.tiles.tile({z, t.x, t.y, true, limits_of()})->bytes,
                  known.tiles.tile({z, t.x, t.y, true, limits_of()})->bytes);
      }
    }
  }
  EXPECT_GT(empty, 0U);
}

}  // namespace
}  // namespace ptin::tools::testing
