// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain as a pyramid of tiles, whatever their format: the levels, which tiles there are, and
// the mesh of each.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "tools/tiles/globe.h"
#include "tools/tiles/level_mesh.h"
#include "tools/tiles/tile_grid.h"
#include "tools/tiles/tile_levels.h"

namespace ptin::tools {

/// The surface within one tile.
struct TileMesh {
  struct Vertex {
    TilePoint at;         ///< Steps of the lattice from the tile's south-western corner.
    double height = 0.0;  ///< Metres.
    Vec3 normal;          ///< Normal of length 1, earth-centred.
  };
  std::vector<Vertex> vertices;  ///< In the order in which the triangles use them first.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise seen from above.
  QueryCost cost;  ///< Cost of gathering the triangles; the time is that of the mesh.
};

/// A tile as a format has it.
struct Tile {
  std::string bytes;   ///< Not compressed.
  double error = 0.0;  ///< Its surface lies within it of every sample, metres.
  QueryCost cost;
};

/// A closed rectangle of tiles; empty when min > max.
struct TileRectangle {
  std::int64_t min_x = 0, min_y = 0, max_x = -1, max_y = -1;
  friend bool operator==(const TileRectangle&, const TileRectangle&) = default;

  [[nodiscard]] std::int64_t columns() const noexcept {
    return std::max<std::int64_t>(max_x - min_x + 1, 0);
  }
  [[nodiscard]] std::int64_t rows() const noexcept {
    return std::max<std::int64_t>(max_y - min_y + 1, 0);
  }
  [[nodiscard]] bool holds(std::int64_t x, std::int64_t y) const noexcept {
    return min_x <= x && x <= max_x && min_y <= y && y <= max_y;
  }
};

/// Some tiles of one level, as a bitmap over a rectangle.
struct TileSet {
  TileRectangle around;
  std::vector<bool> bits;  ///< Row by row from the south.

  explicit TileSet(const TileRectangle& all = {})
      : around(all), bits(static_cast<std::size_t>(all.columns() * all.rows())) {}
  [[nodiscard]] std::size_t place_of(std::int64_t x, std::int64_t y) const noexcept {
    return static_cast<std::size_t>((y - around.min_y) * around.columns() + (x - around.min_x));
  }
  [[nodiscard]] bool holds(std::int64_t x, std::int64_t y) const noexcept {
    return around.holds(x, y) && bits[place_of(x, y)];
  }
  /// Tiles beyond the rectangle are passed over.
  void add(std::int64_t x, std::int64_t y) {
    if (around.holds(x, y)) bits[place_of(x, y)] = true;
  }
};

struct PyramidOptions {
  /// First level of which tiles are made from the terrain.
  int first_level = 0;
  std::uint32_t most_vertices = 65'000;  ///< Most vertices of a tile.
  /// Levels of about at most this many triangles are looked at whole, to find the tiles that hold
  /// surface. A tile of a level further on is there when its ancestor on the last such level is.
  std::uint64_t coverage_triangles = 200'000;
};

/// Threads: const functions may be called at once.
class TilePyramid {
 public:
  /// @param levels  Not empty.
  /// @param limits  Limits of finding out which tiles hold surface.
  /// @throws Error as Terrain's questions
  /// Cost: some seconds for every million of `coverage_triangles`.
  TilePyramid(Terrain terrain, std::shared_ptr<const Globe> globe, const TileGrid& grid,
              std::vector<TileLevel> levels, const PyramidOptions& options,
              const QueryLimits& limits);

  [[nodiscard]] const Terrain& terrain() const noexcept { return terrain_; }
  [[nodiscard]] const Globe& globe() const noexcept { return *globe_; }
  [[nodiscard]] const TileGrid& grid() const noexcept { return grid_; }
  [[nodiscard]] int finest_level() const noexcept { return static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const TileLevel& level(int z) const {
    return levels_.at(static_cast<std::size_t>(z));
  }

  /// Whether the pyramid has the tile: it holds surface, or a tile below it does.
  [[nodiscard]] bool has(const TileId& tile) const noexcept;
  /// Whether the tile holds surface. Known of looked_at() and the levels before; of further ones it
  /// is has().
  [[nodiscard]] bool has_surface(const TileId& tile) const noexcept;
  /// The last level of which all tiles were looked at; -1 when none was.
  [[nodiscard]] int looked_at() const noexcept { return looked_at_; }
  /// The tiles of a level, as rectangles that do not overlap.
  [[nodiscard]] std::vector<TileRectangle> rectangles(int z) const;

  /// The surface within a tile of a level from first_level on; empty when there is none.
  /// @throws Error resource_exhausted  more than `most_vertices`, or than the memory holds
  ///               corruption, io_error, cancelled
  /// Cost: that of TinParts::part() of the tile, widened by a twelfth on every side.
  [[nodiscard]] TileMesh mesh(const TileId& tile, const QueryLimits& limits) const;

 private:
  /// Columns of a level of a grid that goes around are counted on, beyond the last and before the
  /// first one, to where the terrain lies. The column of a tile in that count.
  [[nodiscard]] std::int64_t unrolled_column(const TileId& tile) const noexcept;
  [[nodiscard]] bool has_unrolled(const TileId& tile) const noexcept;
  /// The tiles that meet the box around the terrain.
  [[nodiscard]] TileRectangle around(int z) const noexcept;
  [[nodiscard]] std::optional<TileSet> look_at(int z, const QueryLimits& limits) const;
  static void cover(const LevelMesh& mesh, TileSet& found);
  void add_ancestors();

  Terrain terrain_;
  std::shared_ptr<const Globe> globe_;
  TileGrid grid_;
  std::vector<TileLevel> levels_;
  PyramidOptions options_;
  int looked_at_ = -1;
  std::vector<TileSet> surface_;  ///< By level, up to looked_at_.
  std::vector<TileSet> tiles_;    ///< With ancestors.
};

}  // namespace ptin::tools
