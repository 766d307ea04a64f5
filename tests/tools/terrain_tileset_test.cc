// SPDX-License-Identifier: GPL-3.0-or-later
//
// 3D Tiles: what neighbours share, errors and regions, subtrees.
#include "tools/tiles/terrain_tileset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

/// The tiles of a tileset, by number.
std::map<std::tuple<int, std::int64_t, std::int64_t>, ReadGlb> contents_of(
    const TerrainTileset& tileset, int level) {
  std::map<std::tuple<int, std::int64_t, std::int64_t>, ReadGlb> contents;
  const std::int64_t side = std::int64_t{1} << level;
  for (std::int64_t y = 0; y < side; ++y) {
    for (std::int64_t x = 0; x < side; ++x) {
      const auto bytes = tileset.content(level, x, y, limits_of());
      EXPECT_EQ(bytes.has_value(), tileset.has_content(level, x, y));
      if (bytes) contents[{level, x, y}] = read_tile_glb(bytes->bytes);
    }
  }
  return contents;
}

TEST(TerrainTileset, NeighboursHaveEqualEdges) {
  const TestFolder folder;
  std::size_t points = 0;
  for (const std::string& path : tiled_terrains(folder, 0)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const TileGrid& grid = tileset.pyramid().grid();
    const Transformed from_space("EPSG:4978", "EPSG:4979");
    for (int level = 1; level <= std::min(3, tileset.pyramid().finest_level()); ++level) {
      const auto contents = contents_of(tileset, level);
      EXPECT_FALSE(contents.empty());
      const double wide = std::ldexp(grid.width, -level);
      const double high = std::ldexp(grid.height, -level);
      // What lies within a quarter of the lattice's step of a meridian or a parallel.
      const auto on = [&](const ReadGlb& glb, std::size_t axis, double at) {
        const double slack = 0.25 * (axis == 0 ? wide : high) / kTileSide;
        Side<std::tuple<Ecef, std::array<float, 3>>> side;
        std::map<std::uint32_t, double> on_side;
        for (std::uint32_t i = 0; i < glb.positions.size(); ++i) {
          Ecef p = from_space(glb.positions[i]);
          if (p[0] < grid.west - 1.0) p[0] += 360.0;
          if (std::abs(p[axis] - at) > slack) continue;
          side.points[{glb.positions[i], glb.normals[i]}] = p[1 - axis];
          on_side[i] = p[1 - axis];
        }
        add_edges(glb.triangles, on_side, side);
        points += side.points.size();
        return side;
      };
      for (const auto& [number, glb] : contents) {
        const auto [l, x, y] = number;
        if (const auto east = contents.find({l, x + 1, y}); east != contents.end()) {
          const double at = grid.west + wide * static_cast<double>(x + 1);
          EXPECT_TRUE(are_equal(on(glb, 0, at), on(east->second, 0, at)))
              << path << " east of " << l << "/" << x << "/" << y;
        }
        if (const auto north = contents.find({l, x, y + 1}); north != contents.end()) {
          const double at = grid.south + high * static_cast<double>(y + 1);
          EXPECT_TRUE(are_equal(on(glb, 1, at), on(north->second, 1, at)))
              << path << " north of " << l << "/" << x << "/" << y;
        }
      }
    }
  }
  EXPECT_GT(points, 500U);
}

TEST(TerrainTileset, LiesWithinItsGeometricErrors) {
  const TestFolder folder;
  for (const std::string& path : tiled_terrains(folder, 1)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const nlohmann::json told = tileset.tileset_json();
    const double first = told.at("root").at("geometricError");
    EXPECT_GE(told.at("geometricError").get<double>(), first);
    const TileGrid& grid = tileset.pyramid().grid();
    const Transformed from_space("EPSG:4978", "EPSG:4979");
    for (int l = 0; l <= std::min(3, tileset.pyramid().finest_level()); ++l) {
      const TileLevel& level = tileset.pyramid().level(l);
      EXPECT_LE(level.error, std::ldexp(first, -l) * (1 + 1e-12));
      std::vector<Ecef> at;
      for (const auto& [number, glb] : contents_of(tileset, l)) {
        for (const Ecef& position : glb.positions) at.push_back(from_space(position));
      }
      const std::array<double, 2> step{0.5 * std::ldexp(grid.width, -l) / kTileSide,
                                       0.5 * std::ldexp(grid.height, -l) / kTileSide};
      const Distances d = distances_of(tiled, at, step, level.tolerance);
      EXPECT_LE(d.from_level, level.chord + level.error / 16) << path << " " << l;
      EXPECT_LE(d.from_full, level.chord + level.error / 16) << path << " " << l;
    }
  }
}

/// West, south, east, north in degrees, and two heights; east beyond 180 where a region lies there.
std::array<double, 6> region_of(const nlohmann::json& tile) {
  std::array<double, 6> region = tile.at("boundingVolume").at("region");
  for (std::size_t i = 0; i < 4; ++i) region[i] *= 180.0 / M_PI;
  if (region[2] < region[0]) region[2] += 360.0;
  return region;
}

/// Vertices, and the middles of triangles, which are flat where the Earth is not.
std::vector<Ecef> places_in(const ReadGlb& glb) {
  std::vector<Ecef> places = glb.positions;
  for (const auto& t : glb.triangles) {
    Ecef middle{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (const std::uint32_t v : t) middle[i] += glb.positions[v][i] / 3;
    }
    places.push_back(middle);
  }
  return places;
}

TEST(TerrainTileset, RegionsHoldTheContents) {
  const TestFolder folder;
  std::size_t places = 0;
  for (const std::string& path : tiled_terrains(folder, 2)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const auto [west, south, east, north, low, high] = region_of(tileset.tileset_json().at("root"));
    const Transformed from_space("EPSG:4978", "EPSG:4979");
    for (int l = 0; l <= std::min(4, tileset.pyramid().finest_level()); ++l) {
      const double wide = std::ldexp(east - west, -l), tall = std::ldexp(north - south, -l);
      // A tile's share of the region may be left by this, degrees of latitude.
      const double beyond =
          (tileset.position_step(l) + 1.5 * tileset.pyramid().level(l).chord) / 110'000.0;
      const double beyond_lon = beyond / std::cos(std::max(-south, north) * M_PI / 180.0);
      for (const auto& [number, glb] : contents_of(tileset, l)) {
        const double x = west + wide * static_cast<double>(std::get<1>(number));
        const double y = south + tall * static_cast<double>(std::get<2>(number));
        for (const Ecef& place : places_in(glb)) {
          Ecef p = from_space(place);
          if (p[0] < west - 1.0) p[0] += 360.0;
          const bool is_held = p[0] >= west && p[0] <= east && p[1] >= south && p[1] <= north &&
                               p[2] >= low && p[2] <= high;
          EXPECT_TRUE(is_held) << path << " " << l << ": " << p[0] << " " << p[1] << " " << p[2];
          EXPECT_TRUE(p[0] >= x - beyond_lon && p[0] <= x + wide + beyond_lon &&
                      p[1] >= y - beyond && p[1] <= y + tall + beyond);
          ++places;
          if (!is_held) return;
        }
      }
    }
  }
  EXPECT_GT(places, 1000U);
}

TEST(TerrainTileset, SubtreesTellWhichContentsThereAre) {
  const TestFolder folder;
  constexpr int kLevels = TerrainTileset::kSubtreeLevels;
  for (const std::string& path : tiled_terrains(folder, 0)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const nlohmann::json told = tileset.tileset_json();
    EXPECT_EQ(told.at("root").at("implicitTiling").at("subtreeLevels"), kLevels);
    EXPECT_EQ(told.at("root").at("implicitTiling").at("availableLevels"),
              tileset.pyramid().finest_level() + 1);
    std::vector<TileNumber> roots{{0, 0, 0}};
    std::size_t contents = 0;
    while (!roots.empty()) {
      const TileNumber root = roots.back();
      roots.pop_back();
      const auto bytes = tileset.subtree(root.z, root.x, root.y);
      ASSERT_TRUE(bytes.has_value());
      const ReadSubtree subtree = read_subtree(*bytes, kLevels);
      for (int l = 0; l <= kLevels; ++l) {
        const std::size_t before = ((std::size_t{1} << (2 * l)) - 1) / 3;
        for (std::size_t y = 0; y < std::size_t{1} << l; ++y) {
          for (std::size_t x = 0; x < std::size_t{1} << l; ++x) {
            std::size_t morton = 0;
            for (int bit = 0; bit < l; ++bit)
              morton |= ((x >> bit & 1) << (2 * bit)) | ((y >> bit & 1) << (2 * bit + 1));
            const TileNumber t{root.z + l, (root.x << l) + static_cast<std::int64_t>(x),
                               (root.y << l) + static_cast<std::int64_t>(y)};
            if (l == kLevels) {
              EXPECT_EQ(subtree.subtrees[morton], tileset.subtree(t.z, t.x, t.y).has_value());
              if (subtree.subtrees[morton]) roots.push_back(t);
              continue;
            }
            const auto content = tileset.content(t.z, t.x, t.y, limits_of());
            const bool has_content = content.has_value();
            if (content) {
              EXPECT_FALSE(read_tile_glb(content->bytes).triangles.empty());
            }
            contents += has_content ? 1 : 0;
            EXPECT_EQ(subtree.contents[before + morton], has_content);
            EXPECT_TRUE(!has_content || subtree.tiles[before + morton]);
            EXPECT_EQ(subtree.tiles[before + morton], tileset.has_tile(t.z, t.x, t.y));
          }
        }
      }
    }
    EXPECT_GT(contents, 4U);
    EXPECT_FALSE(tileset.subtree(1, 0, 0).has_value());
    EXPECT_FALSE(tileset.subtree(-5, 0, 0).has_value());
    EXPECT_FALSE(tileset.content(0, 1, 0, limits_of()).has_value());
  }
}

}  // namespace
}  // namespace ptin::tools::testing
