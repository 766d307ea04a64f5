// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a raster from its heights in the file: two triangles a cell, by one rule.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "engine/geometry/box.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/living/raster_square.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/shape/spot.h"
#include "engine/query/walk/walk.h"
#include "storage/floor.h"

namespace ptin {

/// The heights from which a level is answered: those of the terrain, where it is the full TIN. Null: it
/// is answered from stars.
/// @throws Error as OpenedTerrain::floor()
[[nodiscard]] inline const Floor* floor_for(const OpenedTerrain& terrain, const Detail& detail) {
  return detail.is_full() ? terrain.floor() : nullptr;
}

/// What of the full TIN is wanted.
struct FloorWish {
  GridBox box;  ///< Grid units, closed: triangles whose box meets it.
  /// Whether a box whose heights (codes; empty: all void) lie within an interval may hold what is wanted;
  /// none: it may.
  std::function<bool(const GridBox&, const Interval&)> may_hold;
  /// Takes the cells of a tile before they are triangles; false, or none: they come one by one.
  std::function<bool(const RasterSquare&)> take_cells;
};

/// How many samples the cells have that meet a box.
[[nodiscard]] std::uint64_t floor_samples(const FloorShape& shape, const GridBox& box);

/// Calls begin(most) before the triangles of each tile, of which there are at most so many, and take(t) for each
/// triangle whose box meets that of the wish, void ones too. Its deviation is 0, its heights are those of its corners that have one.
/// @param begin  False ends it.
/// @return False where `begin` ended it.
/// @throws Error corruption, io_error; what the functions throw
/// Cost: the tiles of the box, 1 ns a sample and 20 ns a cell.
bool visit_floor(const Floor& floor, const HeightEncoding& heights, const FloorWish& wish,
                 const std::function<bool(std::size_t)>& begin,
                 const std::function<void(const LivingTriangle&)>& take, Floor::Recent& recent,
                 QueryCost& cost);

/// The caller's part of a best-first search.
class BestCellVisitor {
 public:
  BestCellVisitor() = default;
  BestCellVisitor(const BestCellVisitor&) = delete;
  BestCellVisitor& operator=(const BestCellVisitor&) = delete;
  virtual ~BestCellVisitor() = default;
  /// An upper bound of the merit of triangles in a box whose heights lie within an interval (codes; empty:
  /// all void). Larger ones have no smaller merit; a value of -infinity: nothing there is wanted.
  [[nodiscard]] virtual Merit bound_of_cells(const GridBox& box, const Interval& codes) const = 0;
  /// Whether all that is wanted will probably be visited: of a far file it is announced together.
  [[nodiscard]] virtual bool wants_all_cells() const { return false; }
  /// Called before the triangles of a tile. False: they are left out, and the search ends.
  /// @param box   That of the tile.
  /// @param left  No merit of what was not visited yet is above it.
  virtual bool begin_cells(const GridBox& box, Merit left) = 0;
  virtual void take_cell(const LivingTriangle& t) = 0;
  /// Called after them. Returns the cut-off: what is below it is not read.
  virtual Merit end_cells() = 0;
};

/// Visits the triangles of the tiles of pages by falling merit; those whose box meets `box`.
/// @throws Error corruption, io_error; what the visitor throws
void visit_floor_best_first(const Floor& floor, const HeightEncoding& heights, const GridBox& box,
                            BestCellVisitor& visitor, Merit cut_off, Floor::Recent& recent,
                            QueryCost& cost);

/// The triangle of the full TIN that holds a spot within, and the place of the spot in it.
struct FloorTriangle {
  std::array<LivingTriangle::Corner, 3> corner;  ///< Counter-clockwise, that of least key first.
  std::array<std::int64_t, 3> weight;            ///< As weights_of(), all of them above 0.
  bool is_void = false;

  [[nodiscard]] LivingTriangle living(const HeightEncoding& heights) const noexcept;
  /// REQUIRES: it is not void.  @return As codes_in().
  [[nodiscard]] WeightedCodes codes(const HeightEncoding& heights) const noexcept;
};

/// The triangles of the full TIN at spots, one after the other: quickly, when these come tile by tile
/// along the curve of the tiles. Threads: one owner.
class FloorAtSpots {
 public:
  /// @param floor, recent  Borrowed.
  FloorAtSpots(const Floor& floor, const HeightEncoding& heights, Floor::Recent& recent)
      : floor_(floor), numbers_(floor.numbers()), heights_(heights), recent_(recent) {}

  /// The place of a spot's tile along the curve. Spots in this order read and decode each tile once,
  /// but for those of neighbours that spots on sides of tiles ask for.
  /// REQUIRES: the spot lies on the raster.
  [[nodiscard]] static std::uint64_t along(const FloorShape& shape, Spot spot) noexcept;
  /// Has what the next spots read come together from a file that lies elsewhere: a round for each level of
  /// nodes and one for the pages. Else nothing.
  /// @throws Error corruption, io_error
  /// Cost: 8 bytes a spot, sorted.
  void announce(std::span<const Spot> spots, IoCounters& counters);

  /// The triangle around a spot that lies on no side of a triangle; none: it lies on one, or beside the
  /// raster.
  /// @throws Error corruption, io_error
  /// Cost: its tile, where that is not one of the spots before; else some nanoseconds.
  [[nodiscard]] std::optional<FloorTriangle> within(Spot spot, QueryCost& cost);

  /// Calls take(t) for the triangles of the cells that hold a spot: one cell, two where it lies on a
  /// side, four on a sample, fewer on the border. Beside the raster there is none.
  /// @throws Error corruption, io_error
  /// Cost: the tiles of these cells, where they are not those of spots before.
  void visit(Spot spot, const std::function<void(const LivingTriangle&)>& take, QueryCost& cost);

 private:
  /// A tile that was read: tiles near each other have different places here.
  struct Kept {
    std::uint32_t column = UINT32_MAX, row = UINT32_MAX;
    FloorTile tile;
  };
  static constexpr std::uint32_t kKeptSide = 2;
  [[nodiscard]] const Kept& tile_at(std::uint32_t column, std::uint32_t row, QueryCost& cost);

  const Floor& floor_;
  FloorNumbers numbers_;
  HeightEncoding heights_;
  Floor::Recent& recent_;
  std::array<Kept, kKeptSide * kKeptSide> kept_;
};

}  // namespace ptin
