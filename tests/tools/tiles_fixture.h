// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the tests of tiles for viewers of the globe share: terrains of several kinds, and code that
// reads their tiles back and knows the formats alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/tools/small_terrains.h"
#include "tests/tools/tile_reader.h"
#include "tools/tiles/terrain_tiles.h"

namespace ptin::tools::testing {

inline constexpr double kTileSide = 32767.0;
inline constexpr std::uint64_t kTileMemory = std::uint64_t{256} << 20;

[[nodiscard]] inline QueryLimits limits_of(std::uint64_t bytes = kTileMemory,
                                           std::stop_token stop = {}) {
  return {bytes, std::move(stop)};
}

/// The code of the error that a call ends with; `internal` when it ends with none.
[[nodiscard]] ErrorCode code_of(const std::function<void()>& call);

/// From one CRS to another, by GDAL; x or longitude first.
class Transformed {
 public:
  Transformed(const std::string& from, const std::string& to);
  Ecef operator()(Ecef p) const;

 private:
  std::unique_ptr<OGRCoordinateTransformation> way_;
};

/// A terrain and its tiles.
struct Tiled {
  explicit Tiled(const std::string& path, const TerrainTilesOptions& options = {});

  [[nodiscard]] ReadTerrain read(int z, std::int64_t x, std::int64_t y) const;
  [[nodiscard]] int finest() const { return tiles.pyramid().finest_level(); }

  Terrain terrain;
  CrsFacts crs;
  double metres;
  TerrainTiles tiles;
};

struct TileNumber {
  int z;
  std::int64_t x, y;
};

/// The tiles that layer.json lists of a level.
[[nodiscard]] std::vector<TileNumber> listed(const nlohmann::json& layer, int z);

/// Degrees, of a place within a tile in steps of its lattice.
[[nodiscard]] double lon_of(const TileNumber& t, double u);
[[nodiscard]] double lat_of(const TileNumber& t, double v);

/// The points are in feet of EPSG:2994, which the file of text does not tell.
[[nodiscard]] std::string built_in_feet(const TestFolder& folder);
/// Hills with two holes and a cut-off corner, in UTM.
[[nodiscard]] std::string built_with_holes(const TestFolder& folder);
/// Hills across the meridian of 180 degrees.
[[nodiscard]] std::string built_across_180(const TestFolder& folder);
/// A bay of 240 km, and hills beside it; half of it is cut off along a diagonal. Its triangles are
/// large, and its lines are bent on the globe.
[[nodiscard]] std::string built_wide(const TestFolder& folder);
/// Hills in polar stereographic coordinates, across the meridian of 180 degrees at 75 degrees north.
[[nodiscard]] std::string built_arctic(const TestFolder& folder);
/// All of these, and two real ones; under the sanitizers each third up to so many before the last
/// (tests/support/share_of_cases.h).
[[nodiscard]] std::vector<std::string> tiled_terrains(const TestFolder& folder,
                                                      std::size_t before_last);

/// One side of a tile, as the neighbour sees it: its vertices, each by a place along the side and
/// by all that must be equal, and the edges of triangles that run along it.
template <class Point>
struct Side {
  std::map<Point, double> points;
  std::vector<std::pair<double, double>> edges;
};

template <class Point>
void add_edges(const std::vector<std::array<std::uint32_t, 3>>& triangles,
               const std::map<std::uint32_t, double>& on_side, Side<Point>& side) {
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = on_side.find(t[i]);
      const auto b = on_side.find(t[(i + 1) % 3]);
      if (a != on_side.end() && b != on_side.end() && a->second != b->second)
        side.edges.push_back(std::minmax({a->second, b->second}));
    }
  }
}

/// Whether two sides are one: a vertex of one side is one of the other, unless the other has
/// nothing there, because the border between surface and void runs along the tile's.
template <class Point>
::testing::AssertionResult are_equal(const Side<Point>& a, const Side<Point>& b) {
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const auto& [point, along] : one->points) {
      if (other->points.contains(point)) continue;
      for (const auto& [from, to] : other->edges) {
        if (from <= along && along <= to)
          return ::testing::AssertionFailure()
                 << "a vertex at " << along << " is on one side alone";
      }
    }
  }
  return ::testing::AssertionSuccess();
}

/// Area in degrees squared.
[[nodiscard]] double area_of(const TileNumber& t, const ReadTerrain& tile);

/// How far vertices are from the terrain, metres, less what rounding them to the lattice explains:
/// the range of heights around each.
struct Distances {
  double from_level = 0.0;  ///< From the TIN of the tile's level.
  double from_full = 0.0;   ///< From the full TIN, less the level's certified deviation.
  std::size_t vertices = 0, beside = 0;  ///< `beside`: where the level's TIN is no surface.
};

/// @param step  Half a step of the lattice, degrees, in longitude and latitude.
[[nodiscard]] Distances distances_of(const Tiled& tiled, const std::vector<Ecef>& vertices,
                                     const std::array<double, 2>& step, double tolerance);

}  // namespace ptin::tools::testing
