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
#include "engine/query/shape/spot.h"
#include "storage/floor.h"

namespace ptin {

/// What of the full TIN is wanted.
struct FloorWish {
  GridBox box;  ///< Grid units, closed: triangles whose box meets it.
  /// Whether a box whose heights (codes; empty: all void) lie within an interval may hold what is wanted;
  /// none: it may.
  std::function<bool(const GridBox&, const Interval&)> may_hold;
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
                 const std::function<void(const LivingTriangle&)>& take, IoCounters& counters);

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
  void visit(Spot spot, const std::function<void(const LivingTriangle&)>& take,
             IoCounters& counters);

 private:
  /// A tile that was read: neighbours have different places here.
  struct Kept {
    std::uint32_t column = UINT32_MAX, row = UINT32_MAX;
    FloorTile tile;
  };
  [[nodiscard]] const Kept& tile_at(std::uint32_t column, std::uint32_t row, IoCounters& counters);

  const Floor& floor_;
  HeightEncoding heights_;
  Floor::Page page_;
  std::array<Kept, 4> kept_;
};

}  // namespace ptin
