// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far tiles for Cesium are from the terrain: heights, outlines, the curved Earth, normals.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

TEST(TerrainTiles, LieWithinTheErrorOfTheirLevel) {
  const TestFolder folder;
  for (const std::string& path : tiled_terrains(folder, 0)) {
    const Tiled tiled(path);
    std::size_t vertices = 0, beside = 0;
    for (int z = tiled.tiles.first_level(); z <= tiled.finest(); ++z) {
      const TileLevel& level = tiled.tiles.pyramid().level(z);
      EXPECT_LE(level.error, 77067.0 / std::ldexp(1.0, z));
      EXPECT_LE(level.tolerance * tiled.metres + level.height_step / 2 + level.chord,
                level.error * 15 / 16 * (1 + 1e-12));
      const double step = 0.5 * std::ldexp(180.0, -z) / kTileSide;
      for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
        const ReadTerrain tile = tiled.read(z, t.x, t.y);
        std::vector<Ecef> at;
        for (std::size_t i = 0; i < tile.u.size(); ++i)
          at.push_back({lon_of(t, tile.u[i]), lat_of(t, tile.v[i]), tile.height(i)});
        if (area_of(t, tile) == 0.0) continue;
        const Distances d = distances_of(tiled, at, {step, step}, level.tolerance);
        const double allowed = level.chord + level.height_step / 2 + level.error / 16;
        EXPECT_LE(d.from_level, allowed) << path << " " << z << "/" << t.x << "/" << t.y;
        EXPECT_LE(d.from_full, allowed) << path << " " << z << "/" << t.x << "/" << t.y;
        vertices += d.vertices;
        beside += d.beside;
      }
    }
    EXPECT_GT(vertices, 400U) << path;
    // On the border of surface and void, or of the terrain, rounding decides on which side.
    EXPECT_LT(static_cast<double>(beside), 0.2 * static_cast<double>(vertices)) << path;
  }
}

/// The area of a triangle on the map, in degrees squared: in parts with sides of 2 km at most, which
/// are straight on the globe, too.
double area_on_globe(const std::array<MapPoint, 3>& t, const Transformed& to_globe) {
  const auto side = [&](std::size_t i, std::size_t k) {
    return std::hypot(t[i].x - t[k].x, t[i].y - t[k].y);
  };
  const int parts =
      static_cast<int>(std::ceil(std::max({side(0, 1), side(1, 2), side(2, 0)}) / 2000));
  // Around the outline: what is within cancels.
  std::vector<Ecef> ring;
  for (std::size_t i = 0; i < 3; ++i) {
    const MapPoint &a = t[i], &b = t[(i + 1) % 3];
    for (int k = 0; k < parts; ++k) {
      const double share = static_cast<double>(k) / parts;
      Ecef p = to_globe({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 0.0});
      if (!ring.empty()) p[0] += 360.0 * std::round((ring.back()[0] - p[0]) / 360.0);
      ring.push_back(p);
    }
  }
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    twice += (ring[i][0] - ring[0][0]) * (ring[i + 1][1] - ring[0][1]) -
             (ring[i][1] - ring[0][1]) * (ring[i + 1][0] - ring[0][0]);
  }
  return 0.5 * twice;
}

double area_of_level(const Tiled& tiled, double tolerance) {
  RefineRequest request;
  request.detail.tolerance = tolerance;
  const RefinedTin refined = tiled.terrain.refine(request);
  const Transformed to_globe(tiled.crs.wkt, "EPSG:4326");
  const AffineMap& map = tiled.terrain.store().facts().map;
  double area = 0.0;
  for (std::size_t t = 0; t < refined.tin.triangles.size(); ++t) {
    if (refined.tin.classes[t] != TriangleClass::kSurface) continue;
    std::array<MapPoint, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint p = refined.tin.position(refined.tin.triangles[t].v[i]);
      corners[i] = map.to_map(p.x, p.y);
    }
    area += area_on_globe(corners, to_globe);
  }
  return area;
}

TEST(TerrainTiles, CoverTheSurfaceAndNothingElse) {
  const TestFolder folder;
  for (const std::string& path : tiled_terrains(folder, 1)) {
    const Tiled tiled(path);
    for (int z = tiled.tiles.first_level(); z <= tiled.finest(); ++z) {
      double area = 0.0;
      for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z))
        area += area_of(t, tiled.read(z, t.x, t.y));
      const double expected = area_of_level(tiled, tiled.tiles.pyramid().level(z).tolerance);
      // The outline is rounded to the lattice, and may leave the terrain's by `chord`.
      const GlobeBox& box = tiled.tiles.pyramid().globe().box();
      const double step = std::ldexp(180.0, -z) / kTileSide;
      const double outline = 2 * (box.east - box.west + box.north - box.south);
      const double chord = tiled.tiles.pyramid().level(z).chord / 1e5;  // degrees of latitude
      EXPECT_NEAR(area, expected, 1e-4 * expected + (4 * step + chord) * outline)
          << path << " level " << z;
    }
  }
}

TEST(TerrainTiles, FollowTheCurvedEarth) {
  const TestFolder folder;
  const Tiled tiled(built_wide(folder));
  const Transformed to_space("EPSG:4979", "EPSG:4978");
  const Transformed from_space("EPSG:4978", "EPSG:4979");
  const Transformed to_map("EPSG:4326", tiled.crs.wkt);
  std::size_t long_edges = 0;
  for (int z = 0; z <= tiled.finest(); ++z) {
    const TileLevel& level = tiled.tiles.pyramid().level(z);
    const bool is_flat = z < tiled.tiles.first_level();  // covers what is void, too
    for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
      const ReadTerrain tile = tiled.read(z, t.x, t.y);
      std::vector<Ecef> at, middles;
      std::vector<MapPoint> below;
      for (std::size_t i = 0; i < tile.u.size(); ++i)
        at.push_back(to_space({lon_of(t, tile.u[i]), lat_of(t, tile.v[i]), tile.height(i)}));
      for (const auto& triangle : tile.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
          const Ecef &a = at[triangle[i]], &b = at[triangle[(i + 1) % 3]];
          if (std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) < 5000.0) continue;
          middles.push_back(
              from_space({0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])}));
          const Ecef map = is_flat ? Ecef{} : to_map({middles.back()[0], middles.back()[1], 0.0});
          below.push_back({map[0], map[1]});
        }
      }
      LocateRequest request;
      request.detail.tolerance = level.tolerance;
      const LocateResult located = tiled.terrain.locate(below, request);
      long_edges += middles.size();
      for (std::size_t i = 0; i < middles.size(); ++i) {
        if (!is_flat && located.points[i].state != PointState::kSurface) continue;
        const double height = is_flat ? 0.0 : located.points[i].height;
        EXPECT_NEAR(middles[i][2], height, level.chord + level.height_step / 2 + level.error / 16)
            << z << "/" << t.x << "/" << t.y;
      }
    }
  }
  EXPECT_GT(long_edges, 1000U);
}

TEST(TerrainTiles, NormalsPointUpFromTheSurface) {
  const TestFolder folder;
  const Tiled tiled(built(folder, "mountains_257.tif"));
  const int z = tiled.finest();
  const Transformed to_space("EPSG:4979", "EPSG:4978");
  double worst = 1.0;
  for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
    const ReadTerrain tile = tiled.read(z, t.x, t.y);
    std::vector<Ecef> sums(tile.u.size(), Ecef{});
    std::vector<bool> beside_cut(tile.u.size());
    std::vector<Ecef> at;
    for (std::size_t i = 0; i < tile.u.size(); ++i)
      at.push_back(to_space({lon_of(t, tile.u[i]), lat_of(t, tile.v[i]), tile.height(i)}));
    for (const auto& triangle : tile.triangles) {
      const Ecef &a = at[triangle[0]], &b = at[triangle[1]], &c = at[triangle[2]];
      const Ecef p{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      for (const std::uint32_t i : triangle) {
        sums[i][0] += p[1] * q[2] - p[2] * q[1];
        sums[i][1] += p[2] * q[0] - p[0] * q[2];
        sums[i][2] += p[0] * q[1] - p[1] * q[0];
      }
    }
    for (const auto& triangle : tile.triangles) {
      const bool is_cut = std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t i) {
        return tile.u[i] == 0 || tile.v[i] == 0 || tile.u[i] == 32767 || tile.v[i] == 32767;
      });
      for (const std::uint32_t i : triangle) beside_cut[i] = beside_cut[i] || is_cut;
    }
    for (std::size_t i = 0; i < tile.u.size(); ++i) {
      if (beside_cut[i]) continue;  // its triangles reach into the neighbour
      const Ecef n = oct_decoded(tile.normals[i]);
      const double length = std::hypot(sums[i][0], sums[i][1], sums[i][2]);
      worst = std::min(worst, (n[0] * sums[i][0] + n[1] * sums[i][1] + n[2] * sums[i][2]) / length);
    }
    EXPECT_TRUE(tiled.tiles.tile({z, t.x, t.y, false, limits_of()})->bytes.size() ==
                tiled.tiles.tile({z, t.x, t.y, true, limits_of()})->bytes.size() - 5 -
                    2 * tile.u.size());
  }
  EXPECT_GT(worst, 0.99);  // within 8 degrees: heights and normals are rounded
}

}  // namespace
}  // namespace ptin::tools::testing
