// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/terrain_tiles.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/tiles/quantized_mesh.h"

namespace ptin::tools {

namespace {

/// Cesium's: a 64th of the girth over 65 samples of a heightmap at level 0, a quarter of it.
constexpr double kFirstError = 77067.0;

std::vector<TileLevel> levels_of(const Terrain& terrain, const Globe& globe) {
  const TileGrid grid;
  const GlobeBox& box = globe.box();
  LevelsWanted wanted;
  wanted.first_error = kFirstError;
  wanted.first_area =
      (grid.width / (box.east - box.west)) * (grid.height / (box.north - box.south));
  wanted.least_finest = 1;
  return tile_levels(terrain.store(), globe, wanted);
}

/// As terrain_tiles.h has it.
int first_level_of(const std::vector<TileLevel>& levels, const Globe& globe) {
  const GlobeBox& box = globe.box();
  const double extent = std::max(box.east - box.west, box.north - box.south);
  const double highest = std::max(std::abs(globe.min_height()), std::abs(globe.max_height()));
  int z = 1;
  while (z + 1 < static_cast<int>(levels.size()) &&
         std::ldexp(TileGrid{}.width, -z) >= 2 * extent &&
         highest <= levels[static_cast<std::size_t>(z)].error * 7 / 8) {
    ++z;
  }
  return z;
}

/// The ellipsoid within a tile, so finely that triangles leave it by at most `chord`.
TileMesh flat_mesh(const TileGrid& grid, const TileId& tile, double chord) {
  const double side = 2 * std::acos(1.0 - chord / 2 / kSemiMajor);  // a diagonal bends twice as far
  const double angle = std::ldexp(grid.width * (M_PI / 180.0), -tile.level);
  const auto cells = static_cast<std::int64_t>(std::clamp(std::ceil(angle / side), 1.0, 128.0));
  const TileBox box = TileGrid::box_of(tile);
  TileMesh mesh;
  std::vector<std::uint32_t> numbers(static_cast<std::size_t>((cells + 1) * (cells + 1)), kNone);
  const auto vertex = [&](std::int64_t i, std::int64_t j) {
    std::uint32_t& number = numbers[static_cast<std::size_t>(j * (cells + 1) + i)];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(mesh.vertices.size());
      const TilePoint at{kTileSteps * i / cells, kTileSteps * j / cells};
      const GlobePoint p = grid.globe_point(tile.level, {box.min_u + at.u, box.min_v + at.v}, 0.0);
      mesh.vertices.push_back({at, 0.0, up_at(p.lon, p.lat)});
    }
    return number;
  };
  for (std::int64_t j = 0; j < cells; ++j) {
    for (std::int64_t i = 0; i < cells; ++i) {
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, vertex(i, j + 1)});
    }
  }
  return mesh;
}

/// One triangle without area: nothing to be seen.
TileMesh empty_mesh(const TileGrid& grid, const TileId& tile, double height) {
  const TileBox box = TileGrid::box_of(tile);
  const TilePoint middle{kTileSteps / 2, kTileSteps / 2};
  const GlobePoint p =
      grid.globe_point(tile.level, {box.min_u + middle.u, box.min_v + middle.v}, height);
  TileMesh mesh;
  mesh.vertices.assign(3, {middle, height, up_at(p.lon, p.lat)});
  mesh.triangles.push_back({0, 1, 2});
  return mesh;
}

double longitude_within(double lon) { return lon - 360.0 * std::floor((lon + 180.0) / 360.0); }

}  // namespace

TerrainTiles::TerrainTiles(const Terrain& terrain, const CrsFacts& crs,
                           const TerrainTilesOptions& options, const QueryLimits& limits)
    : TerrainTiles(terrain,
                   std::make_shared<const Globe>(terrain.store().facts(), crs, options.globe),
                   options, limits) {}

TerrainTiles::TerrainTiles(const Terrain& terrain, std::shared_ptr<const Globe> globe,
                           const TerrainTilesOptions& options, const QueryLimits& limits)
    : first_level_(first_level_of(levels_of(terrain, *globe), *globe)),
      pyramid_(terrain, globe, TileGrid{}, levels_of(terrain, *globe),
               {first_level_, options.most_vertices, options.coverage_triangles}, limits) {}

bool TerrainTiles::has(std::int64_t z, std::int64_t x, std::int64_t y) const noexcept {
  if (z == 0) return (x == 0 || x == 1) && y == 0;
  return z > 0 && z <= pyramid_.finest_level() && pyramid_.has({static_cast<int>(z), x, y});
}

std::optional<Tile> TerrainTiles::tile(const TileRequest& request) const {
  if (!has(request.z, request.x, request.y)) return std::nullopt;
  const TileId id{static_cast<int>(request.z), request.x, request.y};
  const TileLevel& level = pyramid_.level(id.level);
  const TileGrid& grid = pyramid_.grid();
  TileMesh mesh;
  if (id.level < first_level_) {
    mesh = flat_mesh(grid, id, level.chord);
  } else {
    mesh = pyramid_.mesh(id, request.limits);
    if (mesh.triangles.empty()) {
      const QueryCost cost = mesh.cost;
      mesh = empty_mesh(grid, id, pyramid_.globe().min_height());
      mesh.cost = cost;
    }
  }
  return Tile{quantized_mesh(mesh, {grid, id, level.height_step, request.normals}), level.error,
              mesh.cost};
}

nlohmann::json TerrainTiles::layer_json(const std::string& version) const {
  const GlobeBox& box = pyramid_.globe().box();
  nlohmann::json available = nlohmann::json::array();
  for (int z = 0; z <= pyramid_.finest_level(); ++z) {
    nlohmann::json level = nlohmann::json::array();
    const std::vector<TileRectangle> tiles =
        z == 0 ? std::vector<TileRectangle>{{0, 0, 1, 0}} : pyramid_.rectangles(z);
    for (const TileRectangle& r : tiles) {
      level.push_back(
          {{"startX", r.min_x}, {"startY", r.min_y}, {"endX", r.max_x}, {"endY", r.max_y}});
    }
    available.push_back(std::move(level));
  }
  nlohmann::json bounds = {-180.0, box.south, 180.0, box.north};
  if (box.east - box.west < 360.0) {
    bounds[0] = longitude_within(box.west);
    const double east = longitude_within(box.east);
    bounds[2] = east == -180.0 ? 180.0 : east;
  }
  return {{"tilejson", "2.1.0"},
          {"name", "terrain"},
          {"version", version},
          {"format", "quantized-mesh-1.0"},
          {"scheme", "tms"},
          {"projection", "EPSG:4326"},
          {"extensions", {"octvertexnormals"}},
          {"tiles", {"{z}/{x}/{y}.terrain?v={version}"}},
          {"minzoom", 0},
          {"maxzoom", pyramid_.finest_level()},
          {"bounds", std::move(bounds)},
          {"available", std::move(available)}};
}

}  // namespace ptin::tools
