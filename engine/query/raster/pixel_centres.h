// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the centres of a rectangle of pixels stand, on the lattice of spots.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/infinity.h"
#include "engine/query/raster/pixel_lattice.h"
#include "engine/query/shape/spot.h"
#include "storage/store_facts.h"

namespace ptin {

/// The centres of a rectangle's pixels. A pixel's place is its number in the rectangle, row by row.
class PixelCentres {
 public:
  /// Positions become spots as SpotMap says, so that they are those that locate() asks about.
  PixelCentres(const StoreFacts& facts, const PixelLattice& lattice, const PixelRect& pixels);

  [[nodiscard]] std::size_t width() const noexcept { return x_.spots.size(); }
  [[nodiscard]] std::size_t height() const noexcept { return y_.spots.size(); }
  [[nodiscard]] Spot spot(std::size_t column, std::size_t row) const noexcept {
    return {x_.spots[x_.turned(column)], y_.spots[y_.turned(row)]};
  }
  /// The smallest box of the grid around the centres, cut to a little more than the grid.
  [[nodiscard]] GridBox box() const noexcept;

  static constexpr std::size_t kNowhere = SIZE_MAX;
  /// Whether the centres are all positions of the grid in their box: then a triangle's corners are
  /// centres, and the smallest triangles hold no other ones.
  [[nodiscard]] bool are_grid_positions() const noexcept { return are_grid_positions_; }
  /// The place of a position of the grid, or kNowhere.  REQUIRES: are_grid_positions()
  [[nodiscard]] std::size_t place_of(GridPoint p) const noexcept {
    const auto column = static_cast<std::size_t>(std::int64_t{p.x} - first_.x);
    const auto row = static_cast<std::size_t>(std::int64_t{p.y} - first_.y);
    if (column >= width() || row >= height()) return kNowhere;  // so are numbers below 0
    return y_.turned(row) * width() + x_.turned(column);
  }

  /// Whether each centre that lies in the box of the terrain is a position of the grid.
  [[nodiscard]] bool are_on_grid() const noexcept { return are_on_grid_; }
  /// Columns, or rows, along one side, ascending: the coordinates of those in the box of the terrain, and
  /// how the first of them is told from its place.
  struct GridLine {
    std::vector<std::int32_t> at;
    std::size_t first;  ///< The column (row) of at[0].
    bool descends;      ///< at[i] is the column first - i, else first + i.
  };
  /// REQUIRES: are_on_grid()
  [[nodiscard]] GridLine columns_on_grid() const {
    return on_grid(x_, bounds_.min_x, bounds_.max_x);
  }
  [[nodiscard]] GridLine rows_on_grid() const { return on_grid(y_, bounds_.min_y, bounds_.max_y); }

  /// Calls found(place, spot) for each centre in the closed triangle a, b, c, counter-clockwise,
  /// and for some that are next to it: what is off is the rounding of where rows enter and leave.
  template <class Found>
  void near(GridPoint a, GridPoint b, GridPoint c, const Found& found) const;
  /// True when the box of a triangle holds no centre.
  [[nodiscard]] bool misses(const GridBox& box) const noexcept;

 private:
  /// Coordinates along one side, ascending.
  struct Axis {
    std::vector<std::int64_t> spots;
    bool descends = false;  ///< Columns or rows count from the end.
    [[nodiscard]] std::size_t turned(std::size_t i) const noexcept {
      return descends ? spots.size() - 1 - i : i;
    }
    /// The first that is not below `v`: about where it would be if they were evenly spaced, as
    /// they are but for rounding and for what lies beyond all grids.
    [[nodiscard]] std::size_t first_from(std::int64_t v) const noexcept;
  };

  [[nodiscard]] static GridLine on_grid(const Axis& axis, std::int32_t low, std::int32_t high);

  GridBox bounds_;
  Axis x_, y_;
  bool are_on_grid_ = false;
  bool are_grid_positions_ = false;
  GridPoint first_;  ///< The least centre, where they are positions of the grid.
};

template <class Found>
void PixelCentres::near(GridPoint a, GridPoint b, GridPoint c, const Found& found) const {
  const std::array<Spot, 3> corner{spot_of(a), spot_of(b), spot_of(c)};
  const std::int64_t high = std::max({corner[0].y, corner[1].y, corner[2].y});
  const std::int64_t low = std::min({corner[0].y, corner[1].y, corner[2].y});
  for (std::size_t j = y_.first_from(low); j < height() && y_.spots[j] <= high; ++j) {
    const std::int64_t y = y_.spots[j];
    double from = kInfinity;
    double to = -kInfinity;
    for (std::size_t i = 0; i < 3; ++i) {
      const Spot p = corner[i];
      const Spot q = corner[(i + 1) % 3];
      if (std::min(p.y, q.y) > y || std::max(p.y, q.y) < y) continue;
      const auto px = static_cast<double>(p.x);
      const auto qx = static_cast<double>(q.x);
      if (p.y == q.y) {
        from = std::min({from, px, qx});
        to = std::max({to, px, qx});
        continue;
      }
      const double x =
          px + static_cast<double>(y - p.y) / static_cast<double>(q.y - p.y) * (qx - px);
      from = std::min(from, x);
      to = std::max(to, x);
    }
    // Coordinates are at most 2^53 and lie within the triangle's sides: three roundings of half a
    // unit each, and one more of the product, stay below this.
    constexpr double kRounding = 4.0;
    for (std::size_t i = x_.first_from(static_cast<std::int64_t>(std::floor(from - kRounding)));
         i < width() && static_cast<double>(x_.spots[i]) <= to + kRounding; ++i) {
      found(y_.turned(j) * width() + x_.turned(i), Spot{x_.spots[i], y});
    }
  }
}

}  // namespace ptin
