// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles for viewers of the globe, read back by code that knows the formats alone, against the
// terrain they were made from.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tests/tools/program.h"
#include "tests/tools/tile_reader.h"
#include "tools/tiles/quantized_mesh.h"
#include "tools/tiles/terrain_tiles.h"
#include "tools/tiles/terrain_tileset.h"
#include "tools/tiles/tile_cut.h"

namespace ptin::tools {
namespace {

using testing::built;
using testing::Ecef;
using testing::expect_done;
using testing::hills;
using testing::make_raster;
using testing::oct_decoded;
using testing::RasterRecipe;
using testing::read_subtree;
using testing::read_terrain_tile;
using testing::read_tile_glb;
using testing::ReadGlb;
using testing::ReadSubtree;
using testing::ReadTerrain;
using testing::TestFolder;

constexpr double kTileSide = 32767.0;
constexpr std::uint64_t kMemory = std::uint64_t{256} << 20;

QueryLimits limits_of(std::uint64_t bytes = kMemory, std::stop_token stop = {}) {
  return {bytes, std::move(stop)};
}

/// From one CRS to another, by GDAL; x or longitude first.
class Transformed {
 public:
  Transformed(const std::string& from, const std::string& to) {
    OGRSpatialReference a, b;
    EXPECT_EQ(a.SetFromUserInput(from.c_str()), OGRERR_NONE);
    EXPECT_EQ(b.SetFromUserInput(to.c_str()), OGRERR_NONE);
    a.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    b.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    way_.reset(OGRCreateCoordinateTransformation(&a, &b));
    EXPECT_NE(way_, nullptr);
  }
  Ecef operator()(Ecef p) const {
    EXPECT_TRUE(way_->Transform(1, &p[0], &p[1], &p[2]));
    return p;
  }

 private:
  std::unique_ptr<OGRCoordinateTransformation> way_;
};

/// A terrain and its tiles.
struct Tiled {
  Tiled(const std::string& path, const TerrainTilesOptions& options = {})
      : terrain(Terrain::open(path)),
        crs(crs_facts(terrain.store())),
        metres(ground_of(crs).metres_per_height),
        tiles(terrain, crs, options, limits_of()) {}

  [[nodiscard]] ReadTerrain read(int z, std::int64_t x, std::int64_t y) const {
    const auto bytes = tiles.tile({z, x, y, true, limits_of()});
    EXPECT_TRUE(bytes.has_value()) << z << "/" << x << "/" << y;
    return read_terrain_tile(bytes->bytes);
  }
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
std::vector<TileNumber> listed(const nlohmann::json& layer, int z) {
  std::vector<TileNumber> tiles;
  std::set<std::pair<std::int64_t, std::int64_t>> known;
  for (const auto& r : layer.at("available").at(static_cast<std::size_t>(z))) {
    for (std::int64_t y = r.at("startY"); y <= r.at("endY"); ++y) {
      for (std::int64_t x = r.at("startX"); x <= r.at("endX"); ++x) {
        EXPECT_TRUE(known.insert({x, y}).second) << "two rectangles hold a tile";
        tiles.push_back({z, x, y});
      }
    }
  }
  return tiles;
}

double lon_of(const TileNumber& t, double u) {
  return -180.0 + std::ldexp(180.0, -t.z) * (static_cast<double>(t.x) + u / kTileSide);
}
double lat_of(const TileNumber& t, double v) {
  return -90.0 + std::ldexp(180.0, -t.z) * (static_cast<double>(t.y) + v / kTileSide);
}

std::string feet_terrain(const TestFolder& folder) { return built(folder, "ground_points.csv"); }

/// The points are in feet of EPSG:2994, which the file of text does not tell.
std::string built_in_feet(const TestFolder& folder) {
  const std::string path = folder.file("feet.ptin");
  expect_done(
      {"build", testing::test_data("ground_points.csv"), "--a-srs", "EPSG:2994", "-o", path, "-q"});
  return path;
}

/// Hills with two holes and a cut-off corner, in UTM.
std::string built_with_holes(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 120;
  recipe.height = 90;
  recipe.nodata = -9999.0;
  recipe.value = [](int c, int r) {
    const bool in_first = std::hypot(c - 40, r - 30) < 12;
    const bool in_second = c > 70 && c < 95 && r > 40 && r < 75;
    return in_first || in_second || c + r < 25 ? -9999.0 : hills(c, r);
  };
  make_raster(folder.file("holes.tif"), recipe);
  expect_done({"build", folder.file("holes.tif"), "-o", folder.file("holes.ptin"), "-q"});
  return folder.file("holes.ptin");
}

/// Hills across the meridian of 180 degrees.
std::string built_across_180(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 80;
  recipe.height = 60;
  recipe.epsg = 4326;
  recipe.west = 179.96;
  recipe.north = -16.0;
  recipe.pixel = 0.001;
  recipe.value = hills;
  make_raster(folder.file("fiji.tif"), recipe);
  expect_done({"build", folder.file("fiji.tif"), "-o", folder.file("fiji.ptin"), "-q"});
  return folder.file("fiji.ptin");
}

/// A bay of 240 km, and hills beside it; half of it is cut off along a diagonal. Its triangles are
/// large, and its lines are bent on the globe.
std::string built_wide(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 61;
  recipe.height = 61;
  recipe.pixel = 4000.0;
  recipe.west = 100000.0;
  recipe.north = 5300000.0;
  recipe.nodata = -9999.0;
  recipe.value = [](int c, int r) { return c + r < 40 ? -9999.0 : c > 50 ? 3 * hills(c, r) : 0.0; };
  make_raster(folder.file("wide.tif"), recipe);
  expect_done({"build", folder.file("wide.tif"), "-o", folder.file("wide.ptin"), "-q"});
  return folder.file("wide.ptin");
}

std::vector<std::string> terrains(const TestFolder& folder) {
  return {built(folder, "coast_257.tif"), built(folder, "mountains_257.tif"), built_in_feet(folder),
          built_with_holes(folder),       built_across_180(folder),           built_wide(folder)};
}

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
  for (const std::string& path : terrains(folder)) {
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

/// Area in degrees squared.
double area_of(const TileNumber& t, const ReadTerrain& tile) {
  double twice = 0.0;
  for (const auto& [a, b, c] : tile.triangles) {
    twice += (double(tile.u[b]) - tile.u[a]) * (double(tile.v[c]) - tile.v[a]) -
             (double(tile.v[b]) - tile.v[a]) * (double(tile.u[c]) - tile.u[a]);
  }
  const double step = std::ldexp(180.0, -t.z) / kTileSide;
  return 0.5 * twice * step * step;
}

/// How far vertices are from the terrain, metres, less what rounding them to the lattice explains:
/// the range of heights around each.
struct Distances {
  double from_level = 0.0;  ///< From the TIN of the tile's level.
  double from_full = 0.0;   ///< From the full TIN, less the level's certified deviation.
  std::size_t vertices = 0, beside = 0;  ///< `beside`: where the level's TIN is no surface.
};

/// @param step  Half a step of the lattice, degrees, in longitude and latitude.
Distances distances_of(const Tiled& tiled, const std::vector<Ecef>& vertices,
                       const std::array<double, 2>& step, double tolerance) {
  const Transformed to_map("EPSG:4326", tiled.crs.wkt);
  const double west = tiled.tiles.pyramid().globe().box().west;
  std::vector<MapPoint> at;
  for (const Ecef& v : vertices) {
    const double lon = v[0] < west - 1.0 ? v[0] + 360.0 : v[0];
    for (const auto& [du, dv] : {std::pair(0, 0), {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
      const Ecef p = to_map({lon + du * step[0], v[1] + dv * step[1], 0.0});
      at.push_back({p[0], p[1]});
    }
  }
  LocateRequest request;
  request.detail.tolerance = tolerance;
  const LocateResult level = tiled.terrain.locate(at, request);
  const LocateResult full = tiled.terrain.locate(at);
  Distances d;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    ++d.vertices;
    const auto distance_to = [&](const LocateResult& located) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (std::size_t k = 5 * i; k < 5 * i + 5; ++k) {
        if (located.points[k].state != PointState::kSurface) return 0.0;
        low = std::min(low, located.points[k].height * tiled.metres);
        high = std::max(high, located.points[k].height * tiled.metres);
      }
      const double middle = located.points[5 * i].height * tiled.metres;
      return std::abs(vertices[i][2] - middle) - (high - low);
    };
    if (level.points[5 * i].state != PointState::kSurface) ++d.beside;
    d.from_level = std::max(d.from_level, distance_to(level));
    d.from_full =
        std::max(d.from_full, distance_to(full) - level.certified_deviation * tiled.metres);
  }
  return d;
}

TEST(TerrainTiles, LieWithinTheErrorOfTheirLevel) {
  const TestFolder folder;
  for (const std::string& path : terrains(folder)) {
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
    EXPECT_GT(vertices, 1000U) << path;
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
      if (p[0] < 0 && a.x > 179.0 && a.x < 181.0) p[0] += 360.0;
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
  for (const std::string& path : terrains(folder)) {
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

TEST(TerrainTiles, AreThereWhereLayerJsonSays) {
  const TestFolder folder;
  for (const std::string& path : terrains(folder)) {
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

TEST(TerrainTiles, HeadersHoldTheirVertices) {
  const TestFolder folder;
  const Transformed to_space("EPSG:4979", "EPSG:4978");
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const std::string& path : {built_in_feet(folder), built(folder, "coast_257.tif")}) {
    const Tiled tiled(path);
    for (int z = 0; z <= tiled.finest(); ++z) {
      for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
        const ReadTerrain tile = tiled.read(z, t.x, t.y);
        std::vector<Ecef> scaled;
        for (std::size_t i = 0; i < tile.u.size(); ++i) {
          const Ecef p = to_space({lon_of(t, tile.u[i]), lat_of(t, tile.v[i]), tile.height(i)});
          const double away = std::hypot(p[0] - tile.sphere_centre[0], p[1] - tile.sphere_centre[1],
                                         p[2] - tile.sphere_centre[2]);
          EXPECT_LE(away, tile.radius + 1e-6);
          EXPECT_LE(tile.height(i), tile.most);
          EXPECT_GE(tile.height(i), tile.least);
          scaled.push_back({p[0] / 6378137.0, p[1] / 6378137.0, p[2] / 6356752.3142451793});
        }
        // As Cesium tells whether a point is below the horizon of a viewer at `c`.
        const auto is_hidden = [](const Ecef& c, const Ecef& p) {
          const double horizon = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - 1;
          const Ecef to{p[0] - c[0], p[1] - c[1], p[2] - c[2]};
          const double along = -(to[0] * c[0] + to[1] * c[1] + to[2] * c[2]);
          const double square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
          return along > horizon && along * along / square > horizon;
        };
        for (int viewer = 0; viewer < 40; ++viewer) {
          Ecef c{share(random), share(random), share(random)};
          const double distance = std::hypot(c[0], c[1], c[2]);
          const double wanted = 1.0 + std::abs(share(random)) * (viewer % 2 == 0 ? 0.01 : 3.0);
          for (double& v : c) v *= wanted / distance;
          if (!is_hidden(c, tile.horizon)) continue;
          for (const Ecef& p : scaled) {
            const double up = std::hypot(p[0], p[1], p[2]);
            EXPECT_TRUE(up < 1.0 || is_hidden(c, p)) << z << "/" << t.x << "/" << t.y;
          }
        }
      }
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

ErrorCode code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

TEST(TerrainTiles, KeepToTheirLimits) {
  const TestFolder folder;
  const Tiled tiled(built(folder, "mountains_257.tif"));
  const int z = tiled.finest();
  const TileNumber t = listed(tiled.tiles.layer_json("1"), z).front();
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(code_of([&] {
              static_cast<void>(
                  tiled.tiles.tile({z, t.x, t.y, true, limits_of(kMemory, stopped.get_token())}));
            }),
            ErrorCode::cancelled);
  EXPECT_EQ(code_of([&] {
              static_cast<void>(tiled.tiles.tile({z, t.x, t.y, true, limits_of(20'000)}));
            }),
            ErrorCode::resource_exhausted);
  EXPECT_EQ(code_of([&] {
              const TerrainTiles other(tiled.terrain, tiled.crs, {},
                                       limits_of(kMemory, stopped.get_token()));
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

TEST(TerrainTiles, KnowWhereHeightsAreMeasuredFrom) {
  const auto datum_of = [](const char* crs) {
    OGRSpatialReference srs;
    EXPECT_EQ(srs.SetFromUserInput(crs), OGRERR_NONE);
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    char* wkt = nullptr;
    EXPECT_EQ(srs.exportToWkt(&wkt, options), OGRERR_NONE);
    const CrsFacts facts = crs_facts(std::string(wkt));
    CPLFree(wkt);
    return vertical_datum(facts);
  };
  EXPECT_EQ(datum_of("EPSG:4979"), VerticalDatum::kEllipsoidal);
  EXPECT_EQ(datum_of("EPSG:32611+5773"), VerticalDatum::kOrthometric);
  EXPECT_EQ(datum_of("EPSG:4326+5703"), VerticalDatum::kOrthometric);
  EXPECT_EQ(datum_of("EPSG:32611"), VerticalDatum::kUnknown);
  EXPECT_EQ(vertical_datum({}), VerticalDatum::kUnknown);
}

TEST(TerrainTiles, CanBeAboveTheEllipsoid) {
  const TestFolder folder;
  const std::string path = folder.file("egm.ptin");
  expect_done({"build", testing::test_data("mountains_257.tif"), "--vertical-crs", "EPSG:5773",
               "-o", path, "-q"});
  TerrainTilesOptions options;
  options.globe.to_ellipsoid = true;
  const Terrain terrain = Terrain::open(path);
  const CrsFacts crs = crs_facts(terrain.store());
  std::unique_ptr<TerrainTiles> above;
  try {
    above = std::make_unique<TerrainTiles>(terrain, crs, options, limits_of());
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    GTEST_SKIP() << "needs PROJ's grid of EGM96";
  }
  const TerrainTiles as_is(terrain, crs, {}, limits_of());
  const int z = above->pyramid().finest_level();
  const auto rectangle = above->pyramid().rectangles(z).front();
  const ReadTerrain high = read_terrain_tile(
      above->tile({z, rectangle.min_x, rectangle.min_y, true, limits_of()})->bytes);
  const ReadTerrain low = read_terrain_tile(
      as_is.tile({z, rectangle.min_x, rectangle.min_y, true, limits_of()})->bytes);
  // EGM96 is 32 to 34 m below the ellipsoid near Los Angeles.
  EXPECT_NEAR(double(high.least) - double(low.least), -33.0, 2.0);
}

TEST(TerrainTiles, NeedToKnowWhereTheyAre) {
  const TestFolder folder;
  const Terrain nowhere = Terrain::open(feet_terrain(folder));
  EXPECT_EQ(code_of([&] {
              const TerrainTiles tiles(nowhere, crs_facts(nowhere.store()), {}, limits_of());
            }),
            ErrorCode::invalid_argument);
  const Terrain unknown = Terrain::open(built(folder, "mountains_257.tif"));
  TerrainTilesOptions options;
  options.globe.to_ellipsoid = true;
  EXPECT_EQ(code_of([&] {
              const TerrainTiles tiles(unknown, crs_facts(unknown.store()), options, limits_of());
            }),
            ErrorCode::invalid_argument);
}

TEST(TilePyramid, KnowsWhichTilesLargeTrianglesMeet) {
  const TestFolder folder;
  const Tiled tiled(built_wide(folder));
  const auto globe = std::make_shared<const Globe>(tiled.terrain.store().facts(), tiled.crs);
  const GlobeBox& box = globe->box();
  const TileGrid grid{box.west, box.south, box.east - box.west, box.north - box.south, 1, 1, false};
  // Few triangles, tiles a hundredth as large.
  const std::vector<TileLevel> levels(6, {2000.0, 1000.0, 1.0, 100.0});
  const TilePyramid pyramid(tiled.terrain, globe, grid, levels, {}, limits_of());
  EXPECT_EQ(pyramid.looked_at(), 5);
  std::size_t with_surface = 0;
  for (int z = 0; z < 6; ++z) {
    for (std::int64_t y = 0; y < std::int64_t{1} << z; ++y) {
      for (std::int64_t x = 0; x < std::int64_t{1} << z; ++x) {
        const bool has_surface = !pyramid.mesh({z, x, y}, limits_of()).triangles.empty();
        EXPECT_EQ(pyramid.has_surface({z, x, y}), has_surface) << z << "/" << x << "/" << y;
        with_surface += has_surface ? 1 : 0;
      }
    }
  }
  EXPECT_GT(with_surface, 500U);
  EXPECT_LT(with_surface, 1200U);
}

/// A mesh of small triangles around the corner of four tiles, a vertex every four steps of the
/// lattice or so: cut points are rounded by a large part of an edge.
Tin tin_around_corner(std::mt19937& random) {
  constexpr std::int32_t kSide = 12;
  Tin tin;
  const auto jitter = [&] { return static_cast<std::int32_t>(random() % 3) - 1; };
  for (std::int32_t y = 0; y <= kSide; ++y) {
    for (std::int32_t x = 0; x <= kSide; ++x) {
      tin.vertices.push_back({{32743 + 4 * x + jitter(), 32743 + 4 * y + jitter()},
                              static_cast<HeightBits>(random() % 1000),
                              kNone});
      tin.has_height.push_back(1);
    }
  }
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const auto a = static_cast<VertexId>(y * (kSide + 1) + x);
      const VertexId b = a + 1, d = a + kSide + 1, c = d + 1;
      const bool rising = random() % 2 == 0;
      tin.triangles.push_back(rising ? Triangle{{a, b, c}, {}} : Triangle{{a, b, d}, {}});
      tin.triangles.push_back(rising ? Triangle{{a, c, d}, {}} : Triangle{{b, c, d}, {}});
      tin.classes.insert(tin.classes.end(), 2, TriangleClass::kSurface);
    }
  }
  return tin;
}

TEST(TileCut, CutsNeighboursInTheSamePoints) {
  // The grid is the lattice.
  StoreFacts facts;
  facts.map = {10.0, 10.0, 0x1p-20, 0x1p-20};
  facts.heights = {HeightType::int32, 1.0, 0.0};
  facts.bounds = {0, 0, 65534, 65534};
  facts.max_height = 1000.0;
  const Globe globe(facts, crs_facts(std::string(SRS_WKT_WGS84_LAT_LONG)));
  const TileGrid grid{10.0, 10.0, 32767 * 0x1p-20, 32767 * 0x1p-20, 2, 2, false};
  TileLevel level;
  level.chord = 1e6;
  using Seen = std::set<std::tuple<std::int64_t, std::int64_t, double, std::array<double, 3>>>;
  std::mt19937 random(3);
  std::size_t compared = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Tin tin = tin_around_corner(random);
    // Sides that meet in the corner: west, east, south, north of it, as each tile sees them.
    std::array<std::array<Seen, 4>, 4> seen;
    for (std::int64_t tile = 0; tile < 4; ++tile) {
      const TileBox box = TileGrid::box_of({0, tile % 2, tile / 2});
      const auto path = globe.path();
      LevelMesh mesh({grid, 0, level}, *path, box.widened(TileCut::kNearby, TileCut::kNearby),
                     1000);
      mesh.add(tin, facts, {});
      TileCut cut(mesh, box);
      std::set<TileCut::Id> ids;
      for (const auto& triangle : mesh.triangles()) {
        const auto& polygon = cut.cut(triangle);
        ids.insert(polygon.begin(), polygon.end());
      }
      for (const TileCut::Id id : ids) {
        const LevelPoint& p = cut.point(id);
        const Vec3 n = cut.normal(id);
        const auto see = [&](std::size_t side) {
          seen[static_cast<std::size_t>(tile)][side].insert(
              {p.at.u, p.at.v, p.height, {n.x, n.y, n.z}});
        };
        if (p.at.v == 32767) see(tile % 2 == 0 ? 0 : 1);
        if (p.at.u == 32767) see(tile / 2 == 0 ? 2 : 3);
      }
    }
    EXPECT_EQ(seen[0][0], seen[2][0]);
    EXPECT_EQ(seen[1][1], seen[3][1]);
    EXPECT_EQ(seen[0][2], seen[1][2]);
    EXPECT_EQ(seen[2][3], seen[3][3]);
    compared += seen[0][0].size();
  }
  EXPECT_GT(compared, 1000U);
}

TEST(HorizonOcclusionPoint, OfOnePointIsAboveIt) {
  const Vec3 p{kSemiMajor + 1000.0, 0.0, 0.0};
  const Vec3 point = horizon_occlusion_point(p, std::vector<Vec3>{p});
  EXPECT_NEAR(point.x, 1.0 + 1000.0 / kSemiMajor, 1e-12);
}

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
  for (const std::string& path : terrains(folder)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const GlobeBox& box = tileset.pyramid().globe().box();
    const Transformed from_space("EPSG:4978", "EPSG:4979");
    for (int level = 1; level <= std::min(3, tileset.pyramid().finest_level()); ++level) {
      const auto contents = contents_of(tileset, level);
      EXPECT_FALSE(contents.empty());
      const double wide = std::ldexp(box.east - box.west, -level);
      const double high = std::ldexp(box.north - box.south, -level);
      // What lies within a quarter of the lattice's step of a meridian or a parallel.
      const auto on = [&](const ReadGlb& glb, std::size_t axis, double at) {
        const double slack = 0.25 * (axis == 0 ? wide : high) / kTileSide;
        Side<std::tuple<Ecef, std::array<float, 3>>> side;
        std::map<std::uint32_t, double> on_side;
        for (std::uint32_t i = 0; i < glb.positions.size(); ++i) {
          Ecef p = from_space(glb.positions[i]);
          if (p[0] < box.west - 1.0) p[0] += 360.0;
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
          const double at = box.west + wide * static_cast<double>(x + 1);
          EXPECT_TRUE(are_equal(on(glb, 0, at), on(east->second, 0, at)))
              << path << " east of " << l << "/" << x << "/" << y;
        }
        if (const auto north = contents.find({l, x, y + 1}); north != contents.end()) {
          const double at = box.south + high * static_cast<double>(y + 1);
          EXPECT_TRUE(are_equal(on(glb, 1, at), on(north->second, 1, at)))
              << path << " north of " << l << "/" << x << "/" << y;
        }
      }
    }
  }
  EXPECT_GT(points, 500U);
}

TEST(TerrainTileset, LiesWithinItsGeometricErrorsAndItsRegion) {
  const TestFolder folder;
  for (const std::string& path : terrains(folder)) {
    const Tiled tiled(path);
    const TerrainTileset tileset(tiled.terrain, tiled.crs, {}, limits_of());
    const nlohmann::json told = tileset.tileset_json();
    const double first = told.at("root").at("geometricError");
    EXPECT_GE(told.at("geometricError").get<double>(), first);
    const auto region = told.at("root").at("boundingVolume").at("region");
    const GlobeBox& box = tileset.pyramid().globe().box();
    const Transformed from_space("EPSG:4978", "EPSG:4979");
    for (int l = 0; l <= std::min(3, tileset.pyramid().finest_level()); ++l) {
      const TileLevel& level = tileset.pyramid().level(l);
      EXPECT_LE(level.error, std::ldexp(first, -l) * (1 + 1e-12));
      std::vector<Ecef> at;
      for (const auto& [number, glb] : contents_of(tileset, l)) {
        for (const Ecef& position : glb.positions) {
          Ecef p = from_space(position);
          if (p[0] < box.west - 1.0) p[0] += 360.0;
          EXPECT_GE(p[2], region.at(4).get<double>());
          EXPECT_LE(p[2], region.at(5).get<double>());
          const double slack = 2e-5 * tileset.position_step(l);  // degrees, of rounding
          EXPECT_TRUE(p[0] > box.west - slack && p[0] < box.east + slack);
          EXPECT_TRUE(p[1] > box.south - slack && p[1] < box.north + slack);
          at.push_back(p);
        }
      }
      const std::array<double, 2> step{0.5 * std::ldexp(box.east - box.west, -l) / kTileSide,
                                       0.5 * std::ldexp(box.north - box.south, -l) / kTileSide};
      const Distances d = distances_of(tiled, at, step, level.tolerance);
      EXPECT_LE(d.from_level, level.chord + level.error / 16) << path << " " << l;
      EXPECT_LE(d.from_full, level.chord + level.error / 16) << path << " " << l;
    }
  }
}

TEST(TerrainTileset, SubtreesTellWhichContentsThereAre) {
  const TestFolder folder;
  constexpr int kLevels = TerrainTileset::kSubtreeLevels;
  for (const std::string& path : terrains(folder)) {
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
}  // namespace ptin::tools
