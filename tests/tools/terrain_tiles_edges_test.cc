// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sides of tiles for Cesium: what neighbours share, and the vertices that a side names.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

/// How far along, height, code of the normal.
using SidePoint = std::tuple<std::uint16_t, double, std::array<std::uint8_t, 2>>;

Side<SidePoint> side_of(const ReadTerrain& tile, const std::vector<std::uint32_t>& indices,
                        const std::vector<std::uint16_t>& along) {
  Side<SidePoint> side;
  std::map<std::uint32_t, double> on_side;
  for (const std::uint32_t i : indices) {
    side.points[{along[i], tile.height(i), tile.normals.at(i)}] = along[i];
    on_side[i] = along[i];
  }
  add_edges(tile.triangles, on_side, side);
  return side;
}

TEST(TerrainTiles, NeighboursHaveEqualEdges) {
  const TestFolder folder;
  for (const std::string& path : tiled_terrains(folder, 2)) {
    std::size_t points = 0, shared = 0;
    const Tiled tiled(path);
    const nlohmann::json layer = tiled.tiles.layer_json("1");
    for (int z = 0; z <= tiled.finest(); ++z) {
      std::map<std::pair<std::int64_t, std::int64_t>, ReadTerrain> read;
      for (const TileNumber& t : listed(layer, z)) read[{t.x, t.y}] = tiled.read(z, t.x, t.y);
      const std::int64_t columns = std::int64_t{2} << z;
      const auto compare = [&](const Side<SidePoint>& a, const Side<SidePoint>& b) {
        points += a.points.size();
        for (const auto& [p, along] : a.points) shared += b.points.contains(p) ? 1 : 0;
        return are_equal(a, b);
      };
      for (const auto& [at, tile] : read) {
        const auto& [x, y] = at;
        if (const auto next = read.find({(x + 1) % columns, y}); next != read.end()) {
          EXPECT_TRUE(compare(side_of(tile, tile.east, tile.v),
                              side_of(next->second, next->second.west, next->second.v)))
              << path << " east of " << z << "/" << x << "/" << y;
        }
        if (const auto next = read.find({x, y + 1}); next != read.end()) {
          EXPECT_TRUE(compare(side_of(tile, tile.north, tile.u),
                              side_of(next->second, next->second.south, next->second.u)))
              << path << " north of " << z << "/" << x << "/" << y;
        }
      }
    }
    EXPECT_GT(points, 250U) << path;
    EXPECT_GT(static_cast<double>(shared), 0.98 * static_cast<double>(points)) << path;
  }
}

TEST(TerrainTiles, SidesNameTheVerticesOnThem) {
  const TestFolder folder;
  const Tiled tiled(built_with_holes(folder));
  for (int z = 0; z <= tiled.finest(); ++z) {
    for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
      const ReadTerrain tile = tiled.read(z, t.x, t.y);
      const auto expect_side = [&](const std::vector<std::uint32_t>& side,
                                   const std::vector<std::uint16_t>& across, std::uint16_t at) {
        const auto count = std::count(across.begin(), across.end(), at);
        EXPECT_EQ(static_cast<std::ptrdiff_t>(side.size()), count);
        for (const std::uint32_t i : side) EXPECT_EQ(across[i], at);
      };
      expect_side(tile.west, tile.u, 0);
      expect_side(tile.south, tile.v, 0);
      expect_side(tile.east, tile.u, 32767);
      expect_side(tile.north, tile.v, 32767);
    }
  }
}

}  // namespace
}  // namespace ptin::tools::testing
