// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines through the cells of a raster, followed from cell to cell.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "engine/geometry/height.h"
#include "engine/mesh/raster_cell.h"
#include "engine/query/living/raster_square.h"

namespace ptin {

/// The triangles of a square, each a bit, and lines that pass them with higher ground on the right.
/// Threads: one owner.
class CellLines {
 public:
  static constexpr std::uint32_t kMostSamples = 64;  ///< Across: a row of samples is 64 bits.
  /// A sample.
  struct Corner {
    GridPoint position;
    std::uint32_t height;  ///< Ordered.
  };

  /// Takes a square.
  /// @param square, heights  Borrowed for the life of what is asked. Two to kMostSamples samples a side.
  void take(const RasterSquare& square, const HeightEncoding& heights);

  /// The least and the greatest height; least > greatest: all is void.
  [[nodiscard]] std::uint32_t least() const noexcept { return least_; }
  [[nodiscard]] std::uint32_t greatest() const noexcept { return greatest_; }

  /// Looks which triangles a level crosses.
  /// @param least_above  The least height that is above it.
  /// @param wants        wants(corner, corner, corner) says whether a triangle of the surface is wanted at all;
  ///                     it is asked once for each that a level may cross, and must not change until take().
  /// @return How many.
  template <class Wants>
  std::size_t find_crossed(std::uint64_t least_above, const Wants& wants);
  /// Follows that level's lines through them, once: begin(below, above) at the edge by which a line comes, and
  /// extend(below, above) at each by which it leaves a triangle.
  template <class Begin, class Extend>
  void follow(const Begin& begin, const Extend& extend);
  /// How many triangles the levels since take() have crossed.
  [[nodiscard]] std::size_t crossed_once() const noexcept;

 private:
  using Row = std::uint64_t;  ///< A bit a sample, or a cell.
  /// Of a row of cells: those of their first triangles, at the lower edge, and of their second ones.
  using Pair = std::array<Row, 2>;

  /// A triangle that a line enters: its cell, which of its two it is, and which of the cell's corners, counted
  /// as RasterCell's, are the ends of the edge.
  struct At {
    std::uint32_t x, y, triangle, below, above;
  };
  [[nodiscard]] bool is_falling(std::uint32_t x, std::uint32_t y) const noexcept {
    return (falling_[y] >> x & 1) != 0;
  }
  [[nodiscard]] Corner corner(const At& at, std::uint32_t number) const noexcept;
  [[nodiscard]] const std::array<std::uint8_t, 3>& triangle_of(const At& at) const noexcept {
    return kCells[is_falling(at.x, at.y) ? 1 : 0][at.triangle];
  }
  /// The triangle at (x, y) with the edge by which a line of the level enters it.
  [[nodiscard]] At entered(std::uint32_t x, std::uint32_t y, std::uint32_t triangle) const noexcept;
  /// Goes through a triangle: `at.below` and `at.above` become the ends of the edge by which the line leaves.
  void pass(At& at) const noexcept;
  /// Goes over that edge. False where the square ends.
  [[nodiscard]] bool enter_next(At& at) const noexcept;
  [[nodiscard]] bool is_above(std::uint32_t x, std::uint32_t y,
                              std::uint32_t number) const noexcept {
    const GridPoint p =
        cell_corner({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}, number);
    return (above_[static_cast<std::size_t>(p.y)] >> p.x & 1) != 0;
  }
  /// Looks which samples the level is not above, and which cells have some of both.
  void find_mixed(std::uint64_t least_above);
  /// Finds the diagonal of a cell, and which of its triangles are surface.
  void cut_cell(std::uint32_t x, std::uint32_t y);
  [[nodiscard]] std::size_t count_crossed();

  static constexpr std::array<CellTriangles, 2> kCells{cell_triangles(Diagonal::kRising),
                                                       cell_triangles(Diagonal::kFalling)};

  RasterSquare square_;
  const HeightEncoding* heights_ = nullptr;
  std::uint32_t least_ = UINT32_MAX, greatest_ = 0;
  std::array<Row, kMostSamples> above_{}, has_height_{}, mixed_{};
  /// Cells are cut when a level comes to them, since levels pass few of all cells: `falling_` and `wanted_` hold
  /// for those.
  std::array<Row, kMostSamples> is_cut_{}, falling_{};
  std::array<Pair, kMostSamples> wanted_{}, crossed_{}, crossed_once_{};
};

template <class Wants>
std::size_t CellLines::find_crossed(std::uint64_t least_above, const Wants& wants) {
  find_mixed(least_above);
  for (std::uint32_t y = 0; y + 1 < square_.height; ++y) {
    for (Row left = mixed_[y] & ~is_cut_[y]; left != 0; left &= left - 1) {
      const auto x = static_cast<std::uint32_t>(std::countr_zero(left));
      cut_cell(x, y);
      for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
        const At at{x, y, triangle, 0, 0};
        const auto& [a, b, c] = triangle_of(at);
        if ((wanted_[y][triangle] >> x & 1) != 0 &&
            !wants(corner(at, a).position, corner(at, b).position, corner(at, c).position)) {
          wanted_[y][triangle] &= ~(Row{1} << x);
        }
      }
    }
  }
  return count_crossed();
}

template <class Begin, class Extend>
void CellLines::follow(const Begin& begin, const Extend& extend) {
  for (std::uint32_t y = 0; y + 1 < square_.height; ++y) {
    for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
      while (crossed_[y][triangle] != 0) {
        At at = entered(static_cast<std::uint32_t>(std::countr_zero(crossed_[y][triangle])), y,
                        triangle);
        begin(corner(at, at.below), corner(at, at.above));
        do {
          crossed_[at.y][at.triangle] &= ~(Row{1} << at.x);
          pass(at);
          extend(corner(at, at.below), corner(at, at.above));
        } while (enter_next(at) && (crossed_[at.y][at.triangle] >> at.x & 1) != 0);
      }
    }
  }
}

}  // namespace ptin
