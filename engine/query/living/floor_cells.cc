// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/floor_cells.h"

#include <algorithm>
#include <array>

#include "engine/mesh/raster_cell.h"
#include "storage/page_columns.h"

namespace ptin {

namespace {

/// Cells by their lower left samples, from the least to the greatest.
struct Cells {
  std::int64_t min_x, min_y, max_x, max_y;

  /// 0 where there is no cell.
  [[nodiscard]] std::size_t triangles() const noexcept {
    const auto along = [](std::int64_t min, std::int64_t max) {
      return static_cast<std::size_t>(std::max<std::int64_t>(max - min + 1, 0));
    };
    return 2 * along(min_x, max_x) * along(min_y, max_y);
  }
};

/// A sample of a tile.
/// @param first  The tile's first sample.
LivingTriangle::Corner corner_of(const FloorTile& tile, const FloorNumbers& numbers,
                                 GridPoint first, std::int32_t x, std::int32_t y) noexcept {
  const std::size_t i = static_cast<std::size_t>(y) * tile.width + static_cast<std::size_t>(x);
  const bool has_height = tile.is_void.empty() || tile.is_void[i] == 0;
  return {{first.x + x, first.y + y}, has_height ? numbers.bits(tile.heights[i]) : 0, has_height};
}

using CellCorners = std::array<LivingTriangle::Corner, 4>;

/// The corners of a cell, counter-clockwise from its lower left one.
CellCorners corners_of(const FloorTile& tile, const FloorNumbers& numbers, GridPoint first,
                       std::int32_t x, std::int32_t y) noexcept {
  const auto at = [&](std::int32_t across, std::int32_t up) {
    return corner_of(tile, numbers, first, x + across, y + up);
  };
  return {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
}

RasterCell cell_of(const CellCorners& corners, const HeightEncoding& heights) noexcept {
  RasterCell cell{};
  for (std::size_t i = 0; i < 4; ++i) {
    cell.code[i] = heights.code(corners[i].height);
    cell.has_height[i] = corners[i].has_height ? 1 : 0;
  }
  return cell;
}

/// The codes of a triangle's corners. A void one has surface on a side, or at a corner, that has heights.
Interval heights_of(const LivingTriangle& t, const HeightEncoding& heights) noexcept {
  Interval codes;
  for (const LivingTriangle::Corner& c : t.corner) {
    if (!c.has_height) continue;
    const double code = heights.code(c.height);
    codes = {std::min(codes.lo, code), std::max(codes.hi, code)};
  }
  return codes;
}

FloorTriangle triangle_of(const LivingTriangle::Corner& a, const LivingTriangle::Corner& b,
                          const LivingTriangle::Corner& c,
                          const std::array<std::int64_t, 3>& weight) noexcept {
  return {{a, b, c}, weight, !(a.has_height && b.has_height && c.has_height)};
}

/// Cells of one tile, as triangles.
class CellsOfTile {
 public:
  CellsOfTile(const Floor& floor, const HeightEncoding& heights) noexcept
      : shape_(floor.facts().shape), numbers_(floor.numbers()), heights_(heights) {}

  /// Those of some cells that a tile has.
  [[nodiscard]] Cells in(std::uint32_t column, std::uint32_t row, const FloorTile& tile,
                         const Cells& cells) const noexcept {
    const std::int64_t left = shape_.first_of(column), low = shape_.first_of(row);
    return {std::max(cells.min_x, left), std::max(cells.min_y, low),
            std::min<std::int64_t>(cells.max_x, left + tile.width - 2),
            std::min<std::int64_t>(cells.max_y, low + tile.height - 2)};
  }
  /// Takes the triangles of those cells that the tile has.
  template <class Take>
  void visit(std::uint32_t column, std::uint32_t row, const FloorTile& tile, const Cells& cells,
             const Take& take) const {
    const GridPoint first{static_cast<std::int32_t>(shape_.first_of(column)),
                          static_cast<std::int32_t>(shape_.first_of(row))};
    const Cells here = in(column, row, tile, cells);
    for (std::int64_t y = here.min_y; y <= here.max_y; ++y) {
      for (std::int64_t x = here.min_x; x <= here.max_x; ++x) {
        visit_cell(tile, first, static_cast<std::int32_t>(x - first.x),
                   static_cast<std::int32_t>(y - first.y), take);
      }
    }
  }

 private:
  template <class Take>
  void visit_cell(const FloorTile& tile, GridPoint first, std::int32_t x, std::int32_t y,
                  const Take& take) const {
    const CellCorners corners = corners_of(tile, numbers_, first, x, y);
    const RasterCell cell = cell_of(corners, heights_);
    for (const auto& numbers : cell_triangles(cell_diagonal(cell, corners[0].position))) {
      LivingTriangle t;
      t.deviation = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        t.corner[i] = corners[numbers[i]];
        t.is_void = t.is_void || !t.corner[i].has_height;
      }
      t.heights = heights_of(t, heights_);
      take(t);
    }
  }

  const FloorShape& shape_;
  const FloorNumbers& numbers_;
  const HeightEncoding heights_;
};

/// The cells that meet a closed box: those beside it, too, whose sides lie on it.
Cells cells_of(const GridBox& box) noexcept {
  return {std::int64_t{box.min_x} - 1, std::int64_t{box.min_y} - 1, box.max_x, box.max_y};
}

/// The cells that hold a spot.
Cells cells_at(Spot spot) noexcept {
  const std::int64_t x = spot.x >> kSpotBits, y = spot.y >> kSpotBits;
  const auto is_between = [](std::int64_t v) {
    return (v & ((std::int64_t{1} << kSpotBits) - 1)) != 0;
  };
  return {is_between(spot.x) ? x : x - 1, is_between(spot.y) ? y : y - 1, x, y};
}

/// The tiles that have some cells; none where the raster has none of them.
std::optional<TileRange> tiles_of(const FloorShape& shape, const Cells& cells) {
  const std::int64_t last_x = std::int64_t{shape.width} - 2;
  const std::int64_t last_y = std::int64_t{shape.height} - 2;
  if (cells.max_x < 0 || cells.max_y < 0 || cells.min_x > last_x || cells.min_y > last_y) {
    return std::nullopt;
  }
  const auto tile = [&](std::int64_t cell, std::int64_t last) {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(cell, 0, last) >> shape.side_log2);
  };
  return TileRange{tile(cells.min_x, last_x), tile(cells.min_y, last_y), tile(cells.max_x, last_x),
                   tile(cells.max_y, last_y)};
}

}  // namespace

std::uint64_t floor_samples(const FloorShape& shape, const GridBox& box) {
  const Cells cells = cells_of(box);
  const auto along = [](std::int64_t min, std::int64_t max, std::uint32_t samples) {
    const std::int64_t first = std::max<std::int64_t>(min, 0);
    const std::int64_t last = std::min<std::int64_t>(max + 1, std::int64_t{samples} - 1);
    return static_cast<std::uint64_t>(std::max<std::int64_t>(last - first + 1, 0));
  };
  return along(cells.min_x, cells.max_x, shape.width) *
         along(cells.min_y, cells.max_y, shape.height);
}

namespace {

/// The samples of tiles with heights in the order of those that are stored elsewhere in the file.
class SquareOfTile {
 public:
  SquareOfTile(const Floor& floor, const HeightEncoding& heights)
      : shape_(floor.facts().shape),
        numbers_(floor.numbers()),
        heights_(heights),
        has_step_(floor.facts().step != 0) {}

  /// The result is there until the next call, and as long as the tile.
  [[nodiscard]] RasterSquare of(const Floor::TileAt& at, const FloorTile& tile) {
    RasterSquare square;
    square.first = {static_cast<std::int32_t>(shape_.first_of(at.column)),
                    static_cast<std::int32_t>(shape_.first_of(at.row))};
    square.width = tile.width;
    square.height = tile.height;
    square.heights = tile.heights;
    square.is_void = tile.is_void;
    if (has_step_) {
      ordered_.resize(tile.samples());
      std::transform(
          tile.heights.begin(), tile.heights.end(), ordered_.begin(),
          [&](OrderedHeight k) { return ordered_height(numbers_.bits(k), heights_.type); });
      square.heights = ordered_;
    }
    return square;
  }

 private:
  const FloorShape& shape_;
  const FloorNumbers& numbers_;
  const HeightEncoding heights_;
  const bool has_step_;
  std::vector<OrderedHeight> ordered_;
};

}  // namespace

bool visit_floor(const Floor& floor, const HeightEncoding& heights, const FloorWish& wish,
                 const std::function<bool(std::size_t)>& begin,
                 const std::function<void(const LivingTriangle&)>& take, Floor::Recent& recent,
                 QueryCost& cost) {
  const CellsOfTile cells(floor, heights);
  SquareOfTile square(floor, heights);
  return floor.visit(
      [&](const Floor::Bounds& b) {
        return meets(b.box, wish.box) && (!wish.may_hold || wish.may_hold(b.box, b.codes));
      },
      [&](const Floor::TileAt& at, const FloorTile& tile) {
        const Cells here = cells.in(at.column, at.row, tile, cells_of(wish.box));
        if (!begin(here.triangles())) return false;
        cost.samples_read += tile.samples();
        if (wish.take_cells && tile.width > 1 && tile.height > 1 &&
            wish.take_cells(square.of(at, tile))) {
          return true;
        }
        cells.visit(at.column, at.row, tile, cells_of(wish.box), [&](const LivingTriangle& t) {
          if (meets(box_of(t), wish.box)) take(t);
        });
        return true;
      },
      recent, cost.io);
}

namespace {

/// Hands the cells of tiles on.
class BestTiles final : public Floor::BestVisitor {
 public:
  BestTiles(const Floor& floor, const HeightEncoding& heights, const GridBox& box,
            BestCellVisitor& visitor, QueryCost& cost)
      : cells_(floor, heights), box_(box), visitor_(visitor), cost_(cost) {}
  [[nodiscard]] Merit bound(const Floor::Bounds& b) const override {
    return meets(b.box, box_) ? visitor_.bound_of_cells(b.box, b.codes) : kNoMerit;
  }
  [[nodiscard]] bool wants_all() const override { return visitor_.wants_all_cells(); }
  Merit visit(const Floor::TileAt& at, const FloorTile& tile, Merit left) override {
    if (!visitor_.begin_cells(at.bounds.box, left)) return kBestMerit;
    cost_.samples_read += tile.samples();
    cells_.visit(at.column, at.row, tile, cells_of(box_), [&](const LivingTriangle& t) {
      if (meets(box_of(t), box_)) visitor_.take_cell(t);
    });
    return visitor_.end_cells();
  }

 private:
  CellsOfTile cells_;
  GridBox box_;
  BestCellVisitor& visitor_;
  QueryCost& cost_;
};

}  // namespace

void visit_floor_best_first(const Floor& floor, const HeightEncoding& heights, const GridBox& box,
                            BestCellVisitor& visitor, Merit cut_off, Floor::Recent& recent,
                            QueryCost& cost) {
  BestTiles tiles(floor, heights, box, visitor, cost);
  floor.visit_best_first(tiles, cut_off, recent, cost.io);
}

LivingTriangle FloorTriangle::living(const HeightEncoding& heights) const noexcept {
  LivingTriangle t;
  t.corner = corner;
  t.is_void = is_void;
  t.deviation = 0.0;
  t.heights = heights_of(t, heights);
  return t;
}

WeightedCodes FloorTriangle::codes(const HeightEncoding& heights) const noexcept {
  // Of three corners from the least one around, the other two stand by their keys or the other way.
  const std::size_t second = key_of(corner[1].position) < key_of(corner[2].position) ? 1 : 2;
  WeightedCodes codes;
  codes.count = 3;
  std::size_t k = 0;
  for (const std::size_t i : {std::size_t{0}, second, 3 - second}) {
    codes.code[k] = heights.code(corner[i].height);
    codes.weight[k++] = weight[i];
  }
  return codes;
}

const FloorAtSpots::Kept& FloorAtSpots::tile_at(std::uint32_t column, std::uint32_t row,
                                                QueryCost& cost) {
  Kept& kept = kept_[column % kKeptSide + kKeptSide * (row % kKeptSide)];
  if (kept.column != column || kept.row != row) {
    kept.column = UINT32_MAX;  // until it is read
    floor_.read(column, row, recent_, kept.tile, cost.io);
    cost.samples_read += kept.tile.samples();
    kept.column = column;
    kept.row = row;
  }
  return kept;
}

std::uint64_t FloorAtSpots::along(const FloorShape& shape, Spot spot) noexcept {
  const auto tile = [&](std::int64_t v, std::uint32_t samples) {
    const std::int64_t last = std::max<std::int64_t>(0, std::int64_t{samples} - 2);
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(v >> kSpotBits, 0, last) >>
                                      shape.side_log2);
  };
  return FloorShape::key(tile(spot.x, shape.width), tile(spot.y, shape.height));
}

void FloorAtSpots::announce(std::span<const Spot> spots, IoCounters& counters) {
  if (!floor_.is_far()) return;
  std::vector<std::uint64_t> keys;
  for (const Spot spot : spots) {
    const std::optional<TileRange> tiles = tiles_of(floor_.facts().shape, cells_at(spot));
    if (!tiles) continue;
    for (std::uint32_t row = tiles->first_row; row <= tiles->last_row; ++row) {
      for (std::uint32_t column = tiles->first_column; column <= tiles->last_column; ++column) {
        keys.push_back(FloorShape::key(column, row));
      }
    }
  }
  std::sort(keys.begin(), keys.end());
  floor_.announce(keys, recent_, counters);
}

std::optional<FloorTriangle> FloorAtSpots::within(Spot spot, QueryCost& cost) {
  constexpr std::int64_t kUnit = std::int64_t{1} << kSpotBits;
  const FloorShape& shape = floor_.facts().shape;
  const std::int64_t x = spot.x >> kSpotBits, y = spot.y >> kSpotBits;
  const std::int64_t across = spot.x & (kUnit - 1), up = spot.y & (kUnit - 1);
  if (across == 0 || up == 0 || x < 0 || y < 0 || x > std::int64_t{shape.width} - 2 ||
      y > std::int64_t{shape.height} - 2) {
    return std::nullopt;
  }
  const auto column = static_cast<std::uint32_t>(x >> shape.side_log2);
  const auto row = static_cast<std::uint32_t>(y >> shape.side_log2);
  const GridPoint first{static_cast<std::int32_t>(shape.first_of(column)),
                        static_cast<std::int32_t>(shape.first_of(row))};
  const CellCorners corners =
      corners_of(tile_at(column, row, cost).tile, numbers_, first,
                 static_cast<std::int32_t>(x) - first.x, static_cast<std::int32_t>(y) - first.y);
  const Diagonal diagonal = cell_diagonal(cell_of(corners, heights_), corners[0].position);
  const bool is_rising = diagonal == Diagonal::kRising;
  // Above 0 in the cell's lower triangle: how far the spot lies below the diagonal.
  const std::int64_t below = is_rising ? across - up : kUnit - across - up;
  if (below == 0) return std::nullopt;
  // The triangles of cell_triangles(), by constants: numbers that are only known here would have the
  // corners read back from memory before they are all written there.
  static_assert(cell_triangles(Diagonal::kRising) == CellTriangles{{{0, 1, 2}, {0, 2, 3}}});
  static_assert(cell_triangles(Diagonal::kFalling) == CellTriangles{{{0, 1, 3}, {1, 2, 3}}});
  const auto& [low_left, low_right, up_right, up_left] = corners;
  if (is_rising) {
    return below > 0 ? triangle_of(low_left, low_right, up_right, {kUnit - across, below, up})
                     : triangle_of(low_left, up_right, up_left, {kUnit - up, across, -below});
  }
  return below > 0
             ? triangle_of(low_left, low_right, up_left, {below, across, up})
             : triangle_of(low_right, up_right, up_left, {kUnit - up, -below, kUnit - across});
}

void FloorAtSpots::visit(Spot spot, const std::function<void(const LivingTriangle&)>& take,
                         QueryCost& cost) {
  const FloorShape& shape = floor_.facts().shape;
  const Cells wanted = cells_at(spot);
  const std::optional<TileRange> tiles = tiles_of(shape, wanted);
  if (!tiles) return;
  const CellsOfTile cells(floor_, heights_);
  for (std::uint32_t row = tiles->first_row; row <= tiles->last_row; ++row) {
    for (std::uint32_t column = tiles->first_column; column <= tiles->last_column; ++column) {
      const Kept& kept = tile_at(column, row, cost);
      cells.visit(column, row, kept.tile, wanted, take);
    }
  }
}

}  // namespace ptin
