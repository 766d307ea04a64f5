// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/terrain_tileset.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/tiles/tile_bytes.h"
#include "tools/tiles/tile_glb.h"

namespace ptin::tools {

namespace {

/// Positions of a level are multiples of this, metres: a power of two.
double position_step_of(double error, double extent, int level) {
  // Heights are not rounded, so this is all that positions lose beside the lattice's share.
  const double finest = std::ldexp(extent, -level - 22);
  return std::ldexp(1.0, std::ilogb(std::max(error / 1024, finest)));
}

/// How far the content of a level may lie beside the terrain's domain, metres: by the rounding of
/// positions, less than a step, and by the straight edges of triangles on a curved Earth. Edges leave
/// their place by `chord` at most, a triangle's middle by less than half as much again.
double beyond_domain(const TileLevel& level, double extent) {
  return position_step_of(level.error, extent, 0) + 1.5 * level.chord;
}

/// The box that is divided into tiles: it holds what the coarsest level's content takes.
TileGrid grid_of(const Globe& globe, double beyond) {
  const GlobeBox& box = globe.box();
  constexpr double kLeastCurve = 6335439.0;    // metres, of a meridian
  constexpr double kLeastParallel = 1e-3;      // of the equator: next to a pole no longitude is far
  constexpr double kMostWidth = 360.0 - 1e-9;  // west and east are not to be the same meridian
  const double degrees = beyond / kLeastCurve * (180.0 / M_PI);
  const double south = std::max(-90.0, box.south - degrees);
  const double north = std::min(90.0, box.north + degrees);
  const double farthest = std::max(std::abs(south), std::abs(north));
  const double wider = degrees / std::max(std::cos(farthest * (M_PI / 180.0)), kLeastParallel);
  const double width = std::min(box.east - box.west + 2 * wider, kMostWidth);
  return {0.5 * (box.west + box.east - width), south, width, north - south, 1, 1, false};
}

/// The diagonal of the box around the terrain, by its sides over ground: it is no less than that of
/// any tile, however far the Earth curves away.
double extent_of(const Globe& globe) {
  const GlobeBox& box = globe.box();
  const double to_equator =
      box.south <= 0 && box.north >= 0 ? 0.0 : std::min(std::abs(box.south), std::abs(box.north));
  const double metres = kSemiMajor * M_PI / 180.0;
  return std::hypot((box.east - box.west) * metres * std::cos(to_equator * M_PI / 180.0),
                    (box.north - box.south) * metres, globe.max_height() - globe.min_height());
}

double wanted_error(const Terrain& terrain, const Globe& globe, double extent) {
  return std::min(coarsest_error(terrain.store(), globe), extent / 64);
}

std::vector<TileLevel> tileset_levels_of(const Terrain& terrain, const Globe& globe,
                                         double first_error) {
  LevelsWanted wanted;
  wanted.first_error = first_error;
  return tile_levels(terrain.store(), globe, wanted);
}

/// Bits in the order of the Morton curve, level after level.
class Availability {
 public:
  void add(bool bit) {
    if (bits_ % 8 == 0) bytes_.push_back('\0');
    if (bit) {
      bytes_.back() =
          static_cast<char>(static_cast<unsigned char>(bytes_.back()) | 1U << bits_ % 8);
      ++ones_;
    }
    ++bits_;
  }
  /// Its part of the subtree's JSON; its bytes go into `buffer` unless all bits are the same.
  nlohmann::json told(nlohmann::json& views, TileBytes& buffer) const {
    if (ones_ == 0 || ones_ == bits_) return {{"constant", ones_ == 0 ? 0 : 1}};
    views.push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes_.size()}});
    buffer.add_text(bytes_);
    buffer.align(8);
    return {{"bitstream", views.size() - 1}, {"availableCount", ones_}};
  }

 private:
  std::string bytes_;
  std::size_t bits_ = 0, ones_ = 0;
};

/// Calls visit(x, y) for the 4^levels tiles below a tile along the Morton curve.
template <class Visit>
void walk_morton(std::int64_t x, std::int64_t y, int levels, const Visit& visit) {
  const std::int64_t count = std::int64_t{1} << (2 * levels);
  for (std::int64_t i = 0; i < count; ++i) {
    std::int64_t dx = 0, dy = 0;
    for (int bit = 0; bit < levels; ++bit) {
      dx |= ((i >> (2 * bit)) & 1) << bit;
      dy |= ((i >> (2 * bit + 1)) & 1) << bit;
    }
    visit((x << levels) + dx, (y << levels) + dy);
  }
}

std::string subtree_bytes(nlohmann::json json, const nlohmann::json& views, std::string buffer) {
  if (!buffer.empty()) {
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    json["bufferViews"] = views;
  }
  std::string text = json.dump();
  text.resize((text.size() + 7) / 8 * 8, ' ');
  TileBytes out;
  out.add_text("subt");
  out.add(std::uint32_t{1});
  out.add(static_cast<std::uint64_t>(text.size()));
  out.add(static_cast<std::uint64_t>(buffer.size()));
  out.add_text(text);
  out.add_text(buffer);
  return out.take();
}

}  // namespace

TerrainTileset::TerrainTileset(const Terrain& terrain, const CrsFacts& crs,
                               const TerrainTilesOptions& options, const QueryLimits& limits)
    : TerrainTileset(terrain,
                     std::make_shared<const Globe>(terrain.store().facts(), crs, options.globe),
                     options, limits) {}

TerrainTileset::TerrainTileset(const Terrain& terrain, std::shared_ptr<const Globe> globe,
                               const TerrainTilesOptions& options, const QueryLimits& limits)
    : extent_(extent_of(*globe)),
      first_error_(wanted_error(terrain, *globe, extent_)),
      pyramid_(made_pyramid(terrain, std::move(globe), options, limits)) {
  // A file that has no error as large as that of its only level has one level alone.
  first_error_ = std::max(first_error_, pyramid_.level(0).error);
}

TilePyramid TerrainTileset::made_pyramid(const Terrain& terrain, std::shared_ptr<const Globe> globe,
                                         const TerrainTilesOptions& options,
                                         const QueryLimits& limits) const {
  std::vector<TileLevel> levels = tileset_levels_of(terrain, *globe, first_error_);
  const TileGrid grid = grid_of(*globe, beyond_domain(levels.front(), extent_));
  return {terrain,
          std::move(globe),
          grid,
          std::move(levels),
          {0, options.most_vertices, options.coverage_triangles},
          limits};
}

double TerrainTileset::position_step(int level) const {
  return position_step_of(pyramid_.level(level).error, extent_, level);
}

bool TerrainTileset::has_tile(std::int64_t level, std::int64_t x, std::int64_t y) const noexcept {
  if (level == 0 && x == 0 && y == 0) return true;
  return level >= 0 && level <= pyramid_.finest_level() &&
         pyramid_.has({static_cast<int>(level), x, y});
}

bool TerrainTileset::has_content(std::int64_t level, std::int64_t x,
                                 std::int64_t y) const noexcept {
  return level >= 0 && level <= pyramid_.finest_level() &&
         pyramid_.has_surface({static_cast<int>(level), x, y});
}

nlohmann::json TerrainTileset::tileset_json() const {
  const TileGrid& grid = pyramid_.grid();
  const auto radians = [](double degrees) { return degrees * (M_PI / 180.0); };
  const double grid_east = grid.west + grid.width;
  const double east = grid_east > 180.0 ? grid_east - 360.0 : grid_east;
  const double west = grid.west < -180.0 ? grid.west + 360.0 : grid.west;
  const double slack = beyond_domain(pyramid_.level(0), extent_);
  nlohmann::json root = {
      {"boundingVolume",
       {{"region",
         {radians(west), radians(grid.south), radians(east), radians(grid.south + grid.height),
          pyramid_.globe().min_height() - slack, pyramid_.globe().max_height() + slack}}}},
      {"geometricError", first_error_},
      {"refine", "REPLACE"},
      {"content", {{"uri", "content/{level}/{x}/{y}.glb"}}},
      {"implicitTiling",
       {{"subdivisionScheme", "QUADTREE"},
        {"subtreeLevels", kSubtreeLevels},
        {"availableLevels", pyramid_.finest_level() + 1},
        {"subtrees", {{"uri", "subtrees/{level}/{x}/{y}.subtree"}}}}}};
  const double range = pyramid_.globe().max_height() - pyramid_.globe().min_height();
  return {{"asset", {{"version", "1.1"}}},
          // The error of drawing nothing at all: what is missed are the heights.
          {"geometricError", std::max(2 * first_error_, range)},
          {"root", std::move(root)}};
}

std::optional<std::string> TerrainTileset::subtree(std::int64_t level, std::int64_t x,
                                                   std::int64_t y) const {
  if (level % kSubtreeLevels != 0 || !has_tile(level, x, y)) return std::nullopt;
  Availability tiles, contents, below;
  for (int l = 0; l < kSubtreeLevels; ++l) {
    walk_morton(x, y, l, [&](std::int64_t at_x, std::int64_t at_y) {
      tiles.add(has_tile(level + l, at_x, at_y));
      contents.add(has_content(level + l, at_x, at_y));
    });
  }
  walk_morton(x, y, kSubtreeLevels, [&](std::int64_t at_x, std::int64_t at_y) {
    below.add(has_tile(level + kSubtreeLevels, at_x, at_y));
  });
  nlohmann::json views = nlohmann::json::array();
  TileBytes buffer;
  nlohmann::json json;
  json["tileAvailability"] = tiles.told(views, buffer);
  json["contentAvailability"] = nlohmann::json::array({contents.told(views, buffer)});
  json["childSubtreeAvailability"] = below.told(views, buffer);
  return subtree_bytes(std::move(json), views, buffer.take());
}

std::optional<Tile> TerrainTileset::content(std::int64_t level, std::int64_t x, std::int64_t y,
                                            const QueryLimits& limits) const {
  if (!has_content(level, x, y)) return std::nullopt;
  const TileId id{static_cast<int>(level), x, y};
  const TileMesh mesh = pyramid_.mesh(id, limits);
  return Tile{tile_glb(mesh, {pyramid_.grid(), id, position_step(id.level)}),
              pyramid_.level(id.level).error, mesh.cost};
}

}  // namespace ptin::tools
