// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a raster from its heights in the file: two triangles a cell, by one rule.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "engine/geometry/box.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/living/raster_square.h"
#include "engine/query/select/accounting.h"
#include "engine/query/shape/spot.h"
#include "storage/floor.h"

namespace ptin {

/// What of the full TIN is wanted.
struct FloorWish {
  GridBox box;  ///< Grid units, closed: triangles whose box meets it.
  /// Whether a box whose heights (codes; empty: all void) lie within an interval may hold what is wanted;
  /// none: it may.
  std::function<bool(const GridBox&, const Interval&)> may_hold;
  /// Takes the cells of a tile before they are triangles; false, or none: they come one by one.
  std::function<bool(const RasterSquare&)> take_cells;
};

/// How many samples the tiles have whose cells meet a box, about.
[[nodiscard]] std::uint64_t floor_samples(const FloorShape& shape, const GridBox& box);

/// Calls begin(most) before the triangles of each tile, of which there are at most so many, and take(t) for each
/// triangle whose box meets that of the wish, void ones too. Its deviation is 0, its heights are those of its corners that have one.
/// @param begin  False ends it.
/// @return False where `begin` ended it.
/// @throws Error corruption, io_error; what the functions throw
/// Cost: the tiles of the box, 1 ns a sample and 20 ns a cell.
bool visit_floor(const Floor& floor, const HeightEncoding& heights, const FloorWish& wish,
                 const std::function<bool(std::size_t)>& begin,
                 const std::function<void(const LivingTriangle&)>& take, QueryCost& cost);

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
                            BestCellVisitor& visitor, Merit cut_off, QueryCost& cost);

/// The triangles of the full TIN at spots, one after the other. Threads: one owner.
class FloorAtSpots {
 public:
  /// @param floor  Borrowed.
  FloorAtSpots(const Floor& floor, const HeightEncoding& heights)
      : floor_(floor), heights_(heights) {}

  /// Calls take(t) for the triangles of the cells that hold a spot: one cell, two where it lies on a
  /// side, four on a sample, fewer on the border. Beside the raster there is none.
  /// @throws Error corruption, io_error
  /// Cost: the tiles of these cells, where they are not those of the spot before.
  void visit(Spot spot, const std::function<void(const LivingTriangle&)>& take, QueryCost& cost);

 private:
  /// A tile that was read: neighbours have different places here.
  struct Kept {
    std::uint32_t column = UINT32_MAX, row = UINT32_MAX;
    FloorTile tile;
  };
  [[nodiscard]] const Kept& tile_at(std::uint32_t column, std::uint32_t row, QueryCost& cost);

  const Floor& floor_;
  HeightEncoding heights_;
  Floor::Page page_;
  std::array<Kept, 4> kept_;
};

}  // namespace ptin
