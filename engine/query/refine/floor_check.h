// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the full TIN is the one that the heights of the raster in the file make.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/mesh/raster_cell.h"
#include "engine/mesh/tin.h"
#include "engine/query/shape/grid_cell.h"
#include "storage/file/io_counters.h"
#include "storage/floor.h"
#include "storage/store_facts.h"
#include "storage/verify.h"

namespace ptin {

/// Holds the full TIN, cell by cell, against the two triangles of each square of four samples. A triangle
/// belongs to the cell with the lowest of its corners, of two the left one: so each is looked at in one
/// cell, and meets that. Where no cell has a fault and the TIN covers the domain once, both are the same.
class FloorCheck {
 public:
  /// Memory for each position of a cell's box, and of a rim of one around it.
  static constexpr std::uint64_t kPositionBytes = 6;

  /// @param floor  Borrowed, as the facts of its file.
  FloorCheck(const Floor& floor, const StoreFacts& facts) : floor_(floor), facts_(facts) {}

  /// @param tin  Is the full TIN on every triangle that meets the cell.
  /// @return The first fault that is met; none where there is none.
  /// @throws Error corruption, io_error
  /// Cost: the tiles of the cell, and 10 ns a triangle of the mesh.
  [[nodiscard]] std::optional<VerifyFault> fault_in(const Tin& tin, const GridCell& cell,
                                                    IoCounters& counters);

 private:
  enum class Sample : std::uint8_t { kUnread, kVoid, kLone, kHeight };
  [[nodiscard]] std::optional<VerifyFault> read(IoCounters& counters);
  [[nodiscard]] bool put(const Floor::TileAt& at, const FloorTile& tile);
  [[nodiscard]] std::size_t place_of(std::int64_t x, std::int64_t y) const noexcept {
    return static_cast<std::size_t>(y - samples_.min_y) * width_ +
           static_cast<std::size_t>(x - samples_.min_x);
  }
  [[nodiscard]] bool has_height(GridPoint p) const noexcept {
    return state_[place_of(p.x, p.y)] == Sample::kHeight;
  }
  [[nodiscard]] Diagonal diagonal_at(GridPoint corner) const;
  [[nodiscard]] std::string fault_in_triangle(const Tin& tin, TriangleId t);
  [[nodiscard]] std::optional<GridPoint> missing(const GridCell& cell) const;

  const Floor& floor_;
  const StoreFacts& facts_;
  // The cell at hand:
  GridBox samples_;
  std::size_t width_ = 0;
  std::vector<HeightBits> heights_;
  std::vector<Sample> state_;
  std::vector<std::uint8_t>
      found_;  ///< Of the square whose lower left sample it is, a bit a triangle.
};

}  // namespace ptin
