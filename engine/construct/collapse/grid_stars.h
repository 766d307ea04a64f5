// SPDX-License-Identifier: GPL-3.0-or-later
//
// The choice of w in the full TIN of a raster, from a table: there a star has one of sixteen shapes
// and no sample but its own.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// Chooses w for the vertices of a leaf over a raster in which nothing was collapsed yet. Borrows
/// the tile.
class GridStars {
 public:
  /// @param box  REQUIRES: its samples fill tile.tin.vertices row by row (start_raster_tile()).
  /// Cost: linear.
  GridStars(const Tile& tile, const GridBox& box);

  struct Choice {
    VertexId w;
    double error;  ///< As CollapseChoice::error.
  };
  /// What CollapseChooser chooses for `u`, up to rounding. Nothing where the table does not say: on
  /// the border of the box, beside a void or a witness, and where an error of nearly 0 wants exact
  /// arithmetic.
  /// Cost: at most eight residuals.
  [[nodiscard]] std::optional<Choice> choose(VertexId u) const noexcept;

 private:
  [[nodiscard]] bool is_plain(std::int32_t x, std::int32_t y) const noexcept;
  [[nodiscard]] std::uint32_t shape_at(std::int32_t x, std::int32_t y) const noexcept;
  [[nodiscard]] std::optional<double> certified(double error, double largest_z) const noexcept;

  const Tile& tile_;
  std::int32_t width_, height_;
  std::vector<std::uint8_t> rising_;  ///< One for each cell, by its south-western sample.
};

}  // namespace ptin
