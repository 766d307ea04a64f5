// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/tiles_fixture.h"

#include <cmath>
#include <set>

#include "tests/support/share_of_cases.h"

namespace ptin::tools::testing {

ErrorCode code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

Transformed::Transformed(const std::string& from, const std::string& to) {
  OGRSpatialReference a, b;
  EXPECT_EQ(a.SetFromUserInput(from.c_str()), OGRERR_NONE);
  EXPECT_EQ(b.SetFromUserInput(to.c_str()), OGRERR_NONE);
  a.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  b.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  way_.reset(OGRCreateCoordinateTransformation(&a, &b));
  EXPECT_NE(way_, nullptr);
}

Ecef Transformed::operator()(Ecef p) const {
  EXPECT_TRUE(way_->Transform(1, &p[0], &p[1], &p[2]));
  return p;
}

Tiled::Tiled(const std::string& path, const TerrainTilesOptions& options)
    : terrain(Terrain::open(path)),
      crs(crs_facts(terrain.store())),
      metres(ground_of(crs).metres_per_height),
      tiles(terrain, crs, options, limits_of()) {}

ReadTerrain Tiled::read(int z, std::int64_t x, std::int64_t y) const {
  const auto bytes = tiles.tile({z, x, y, true, limits_of()});
  EXPECT_TRUE(bytes.has_value()) << z << "/" << x << "/" << y;
  return read_terrain_tile(bytes->bytes);
}

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

namespace {

/// Makes a raster, and the terrain of it.
std::string built_of(const TestFolder& folder, const std::string& name,
                     const RasterRecipe& recipe) {
  make_raster(folder.file(name + ".tif"), recipe);
  build_terrain(folder.file(name + ".tif"), folder.file(name + ".ptin"));
  return folder.file(name + ".ptin");
}

}  // namespace

std::string built_in_feet(const TestFolder& folder) {
  const std::string path = folder.file("feet.ptin");
  BuildOptions options;
  options.a_srs = "EPSG:2994";
  build_terrain(test_data("ground_points.csv"), path, options);
  return path;
}

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
  return built_of(folder, "holes", recipe);
}

std::string built_across_180(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 80;
  recipe.height = 60;
  recipe.epsg = 4326;
  recipe.west = 179.96;
  recipe.north = -16.0;
  recipe.pixel = 0.001;
  recipe.value = hills;
  return built_of(folder, "fiji", recipe);
}

std::string built_wide(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 61;
  recipe.height = 61;
  recipe.pixel = 4000.0;
  recipe.west = 100000.0;
  recipe.north = 5300000.0;
  recipe.nodata = -9999.0;
  recipe.value = [](int c, int r) { return c + r < 40 ? -9999.0 : c > 50 ? 3 * hills(c, r) : 0.0; };
  return built_of(folder, "wide", recipe);
}

std::string built_arctic(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = 60;
  recipe.height = 50;
  recipe.epsg = 3413;
  recipe.west = -1'200'000.0;
  recipe.north = 1'200'000.0;
  recipe.pixel = 1000.0;
  recipe.value = hills;
  return built_of(folder, "arctic", recipe);
}

std::vector<std::string> tiled_terrains(const TestFolder& folder, std::size_t before_last) {
  using Make = std::string (*)(const TestFolder&);
  std::vector<std::string> paths;
  for (const Make make : test::some_of<Make>(
           {[](const TestFolder& f) { return built(f, "coast_257.tif"); },
            [](const TestFolder& f) { return built(f, "mountains_257.tif"); }, built_with_holes,
            built_in_feet, built_across_180, built_arctic, built_wide},
           3, before_last)) {
    paths.push_back(make(folder));
  }
  return paths;
}

double area_of(const TileNumber& t, const ReadTerrain& tile) {
  double twice = 0.0;
  for (const auto& [a, b, c] : tile.triangles) {
    twice += (double(tile.u[b]) - tile.u[a]) * (double(tile.v[c]) - tile.v[a]) -
             (double(tile.v[b]) - tile.v[a]) * (double(tile.u[c]) - tile.u[a]);
  }
  const double step = std::ldexp(180.0, -t.z) / kTileSide;
  return 0.5 * twice * step * step;
}

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
  const LocateResult full = tiled.terrain.locate(at, {});
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

}  // namespace ptin::tools::testing
