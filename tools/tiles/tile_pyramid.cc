// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/tile_pyramid.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/tiles/tile_cut.h"

namespace ptin::tools {

namespace {

/// A bitmap of a level has at most so many tiles.
constexpr std::int64_t kMostTiles = std::int64_t{1} << 22;
/// Memory of one part of a level that is looked at whole.
constexpr std::uint64_t kPartBytes = std::uint64_t{32} << 20;

/// Rounded down, for negative numbers too.
std::int64_t divided(std::int64_t a, std::int64_t b) noexcept {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Runs of tiles in a row, and those that go on in the row above put together.
std::vector<TileRectangle> rectangles_of(const TileSet& set) {
  std::vector<TileRectangle> found, open;
  for (std::int64_t y = set.around.min_y; y <= set.around.max_y; ++y) {
    std::vector<TileRectangle> row;
    for (std::int64_t x = set.around.min_x; x <= set.around.max_x; ++x) {
      if (!set.holds(x, y)) continue;
      if (row.empty() || row.back().max_x != x - 1) row.push_back({x, y, x, y});
      row.back().max_x = x;
    }
    for (TileRectangle& run : row) {
      const auto below = std::find_if(open.begin(), open.end(), [&](const TileRectangle& r) {
        return r.min_x == run.min_x && r.max_x == run.max_x;
      });
      if (below == open.end()) continue;
      run.min_y = below->min_y;
      open.erase(below);
    }
    found.insert(found.end(), open.begin(), open.end());
    open = std::move(row);
  }
  found.insert(found.end(), open.begin(), open.end());
  return found;
}

/// The vertices and triangles of one tile, as they come.
class TileMeshMaker {
 public:
  TileMeshMaker(const LevelMesh& mesh, const TileBox& box, const TileId& id,
                std::uint32_t most_vertices)
      : mesh_(mesh), box_(box), cut_(mesh, box), id_(id), most_vertices_(most_vertices) {}

  TileMesh made(const std::stop_token& stop) {
    const auto& triangles = mesh_.triangles();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (t % kStopInterval == 0) stop_if_asked(stop, "the tile");
      const std::vector<TileCut::Id>& polygon = cut_.cut(triangles[t]);
      if (!polygon.empty() && cut_.twice_area() != 0) has_area_ = true;
      for (std::size_t i = 2; i < polygon.size(); ++i)
        add({polygon[0], polygon[i - 1], polygon[i]});
    }
    if (!has_area_) return {};
    // All triangles were seen: the normals of cut points are complete.
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const LevelPoint& p = cut_.point(ids_[i]);
      const TilePoint within{p.at.u - box_.min_u, p.at.v - box_.min_v};
      tile_.vertices.push_back({within, p.height, cut_.normal(ids_[i])});
    }
    return std::move(tile_);
  }

 private:
  /// Slivers may lie the other way around on the lattice: they are turned, so that no viewer looks at
  /// their backs.
  [[nodiscard]] bool is_clockwise(const std::array<TileCut::Id, 3>& corners) const {
    const TilePoint a = cut_.point(corners[0]).at, b = cut_.point(corners[1]).at,
                    c = cut_.point(corners[2]).at;
    return (b.u - a.u) * (c.v - a.v) < (b.v - a.v) * (c.u - a.u);
  }

  void add(std::array<TileCut::Id, 3> corners) {
    if (is_clockwise(corners)) std::swap(corners[1], corners[2]);
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      const TileCut::Id id = corners[i];
      if (id >= numbers_.size()) numbers_.resize(id + 1, kNone);
      if (numbers_[id] == kNone) {
        if (ids_.size() >= most_vertices_) refuse_tile();
        numbers_[id] = static_cast<std::uint32_t>(ids_.size());
        ids_.push_back(id);
      }
      triangle[i] = numbers_[id];
    }
    tile_.triangles.push_back(triangle);
  }

  [[noreturn]] void refuse_tile() const {
    throw Error(ErrorCode::resource_exhausted,
                "has more than " + std::to_string(most_vertices_) +
                    " vertices at the error of its level; allow more, or build with --max-error",
                "tile " + std::to_string(id_.level) + "/" + std::to_string(id_.x) + "/" +
                    std::to_string(id_.y));
  }

  const LevelMesh& mesh_;
  TileBox box_;
  TileCut cut_;
  TileId id_;
  std::uint32_t most_vertices_;
  bool has_area_ = false;
  std::vector<std::uint32_t> numbers_;  ///< By point.
  std::vector<TileCut::Id> ids_;        ///< By number.
  TileMesh tile_;
};

}  // namespace

TilePyramid::TilePyramid(Terrain terrain, std::shared_ptr<const Globe> globe, const TileGrid& grid,
                         std::vector<TileLevel> levels, const PyramidOptions& options,
                         const QueryLimits& limits)
    : terrain_(std::move(terrain)),
      globe_(std::move(globe)),
      grid_(grid),
      levels_(std::move(levels)),
      options_(options) {
  const int first = std::min(options_.first_level, finest_level());
  for (int z = 0; z < first; ++z) surface_.emplace_back(around(z));
  for (int z = first; z <= finest_level(); ++z) {
    std::optional<TileSet> found = look_at(z, limits);
    if (!found) break;
    surface_.push_back(std::move(*found));
    looked_at_ = z;
  }
  if (looked_at_ < 0) surface_.clear();
  add_ancestors();
}

TileRectangle TilePyramid::around(int z) const noexcept {
  const GlobeBox& box = globe_->box();
  const TilePoint low = grid_.lattice_point(z, box.west, box.south);
  const TilePoint high = grid_.lattice_point(z, box.east, box.north);
  TileRectangle r{divided(low.u, kTileSteps), divided(low.v, kTileSteps),
                  divided(high.u, kTileSteps), divided(high.v, kTileSteps)};
  r.min_y = std::max<std::int64_t>(r.min_y, 0);
  r.max_y = std::min(r.max_y, (grid_.rows << z) - 1);
  if (!grid_.goes_around) {
    r.min_x = std::max<std::int64_t>(r.min_x, 0);
    r.max_x = std::min(r.max_x, (grid_.columns << z) - 1);
  }
  return r;
}

std::optional<TileSet> TilePyramid::look_at(int z, const QueryLimits& limits) const {
  PartRequest request;
  request.detail.tolerance = level(z).tolerance;
  request.limits = limits.share(1, 2, kPartBytes);
  TinParts parts = terrain_.parts(request);
  const TileRectangle all = around(z);
  if (parts.triangles() > options_.coverage_triangles || all.columns() * all.rows() > kMostTiles)
    return std::nullopt;
  TileSet found(all);
  const Globe::Lease path = globe_->path();
  const std::uint64_t most_triangles = limits.share(1, 2).memory_bytes / LevelMesh::kBytesATriangle;
  const TileBox everywhere{INT64_MIN, INT64_MIN, INT64_MAX, INT64_MAX};
  walk_cells(parts, [&](const GridCell&, Tin& part, double) {
    LevelMesh mesh({grid_, z, level(z)}, *path, everywhere, most_triangles);
    mesh.add(part, terrain_.store().facts(), limits.stop);
    cover(mesh, found);
  });
  return found;
}

void TilePyramid::cover(const LevelMesh& mesh, TileSet& found) {
  const int z = mesh.frame().level;
  for (const LevelMesh::Corners& t : mesh.triangles()) {
    const TileBox box = mesh.box_of(t);
    for (std::int64_t y = divided(box.min_v, kTileSteps); y * kTileSteps < box.max_v; ++y) {
      for (std::int64_t x = divided(box.min_u, kTileSteps); x * kTileSteps < box.max_u; ++x) {
        if (!found.around.holds(x, y) || found.holds(x, y)) continue;
        TileCut cut(mesh, TileGrid::box_of({z, x, y}));
        if (!cut.cut(t).empty() && cut.twice_area() != 0) found.add(x, y);
      }
    }
  }
}

void TilePyramid::add_ancestors() {
  tiles_ = surface_;
  for (int z = looked_at_; z > 0; --z) {
    const TileSet& children = tiles_[static_cast<std::size_t>(z)];
    TileSet& parents = tiles_[static_cast<std::size_t>(z) - 1];
    const TileRectangle& all = children.around;
    for (std::int64_t y = all.min_y; y <= all.max_y; ++y) {
      for (std::int64_t x = all.min_x; x <= all.max_x; ++x) {
        if (children.holds(x, y)) parents.add(x >> 1, y >> 1);
      }
    }
  }
}

bool TilePyramid::has_unrolled(const TileId& tile) const noexcept {
  if (looked_at_ < 0) return around(tile.level).holds(tile.x, tile.y);
  if (tile.level <= looked_at_)
    return tiles_[static_cast<std::size_t>(tile.level)].holds(tile.x, tile.y);
  const int further = tile.level - looked_at_;
  return around(tile.level).holds(tile.x, tile.y) &&
         tiles_[static_cast<std::size_t>(looked_at_)].holds(tile.x >> further, tile.y >> further);
}

std::int64_t TilePyramid::unrolled_column(const TileId& tile) const noexcept {
  const std::int64_t columns = grid_.columns << tile.level;
  for (const std::int64_t turn : {columns, -columns}) {
    if (grid_.goes_around && !has_unrolled(tile) &&
        has_unrolled({tile.level, tile.x + turn, tile.y})) {
      return tile.x + turn;
    }
  }
  return tile.x;
}

bool TilePyramid::has(const TileId& tile) const noexcept {
  if (tile.level < 0 || tile.level > finest_level() || tile.x < 0 || tile.y < 0 ||
      tile.x >= grid_.columns << tile.level || tile.y >= grid_.rows << tile.level) {
    return false;
  }
  return has_unrolled({tile.level, unrolled_column(tile), tile.y});
}

bool TilePyramid::has_surface(const TileId& tile) const noexcept {
  if (!has(tile)) return false;
  return tile.level > looked_at_ ||
         surface_[static_cast<std::size_t>(tile.level)].holds(unrolled_column(tile), tile.y);
}

std::vector<TileRectangle> TilePyramid::rectangles(int z) const {
  const TileRectangle all = around(z);
  std::vector<TileRectangle> unrolled;
  if (looked_at_ < 0) {
    unrolled.push_back(all);
  } else {
    const int known = std::min(z, looked_at_);
    const int further = z - known;
    for (const TileRectangle& r : rectangles_of(tiles_[static_cast<std::size_t>(known)])) {
      const std::int64_t last = (std::int64_t{1} << further) - 1;
      unrolled.push_back({std::max(r.min_x << further, all.min_x),
                          std::max(r.min_y << further, all.min_y),
                          std::min((r.max_x << further) + last, all.max_x),
                          std::min((r.max_y << further) + last, all.max_y)});
    }
  }
  std::vector<TileRectangle> folded;
  const std::int64_t columns = grid_.columns << z;
  for (const TileRectangle& r : unrolled) {
    for (const std::int64_t turn : {std::int64_t{0}, columns, -columns}) {
      const TileRectangle part{std::max<std::int64_t>(r.min_x - turn, 0), r.min_y,
                               std::min(r.max_x - turn, columns - 1), r.max_y};
      if (part.columns() > 0 && part.rows() > 0) folded.push_back(part);
    }
  }
  return folded;
}

TileMesh TilePyramid::mesh(const TileId& tile, const QueryLimits& limits) const {
  const auto start = std::chrono::steady_clock::now();
  const TileId unrolled{tile.level, unrolled_column(tile), tile.y};
  const TileBox box = TileGrid::box_of(unrolled);
  const TileBox keep = box.widened(TileCut::kNearby, TileCut::kNearby);
  const GridBox place = globe_->grid_box(grid_.globe_box(tile.level, keep));
  if (is_empty(place)) return {};
  PartRequest request;
  request.detail.tolerance = level(tile.level).tolerance;
  request.limits = limits.share(1, 2);
  TinParts parts = terrain_.parts(request);
  const Tin* const tin = parts.part(place);
  if (tin == nullptr) {
    throw Error(ErrorCode::resource_exhausted,
                "the tile takes more than the " + std::to_string(limits.memory_bytes) +
                    " bytes of memory given",
                terrain_.store().path());
  }
  const Globe::Lease path = globe_->path();
  LevelMesh mesh({grid_, tile.level, level(tile.level)}, *path, keep,
                 limits.share(1, 2).memory_bytes / LevelMesh::kBytesATriangle);
  mesh.add(*tin, terrain_.store().facts(), limits.stop);
  TileMesh made = TileMeshMaker(mesh, box, tile, options_.most_vertices).made(limits.stop);
  made.cost = parts.cost();
  made.cost.seconds = seconds_since(start);
  return made;
}

}  // namespace ptin::tools
