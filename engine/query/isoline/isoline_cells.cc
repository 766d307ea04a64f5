// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_cells.h"

#include <algorithm>

#include "storage/page_columns.h"

namespace ptin {

namespace {

/// As many ones as there are things in a row.
std::uint64_t ones(std::uint32_t count) noexcept {
  return count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

}  // namespace

void CellLines::take(const RasterSquare& square, const HeightEncoding& heights) {
  square_ = square;
  least_ = UINT32_MAX;
  greatest_ = 0;
  std::size_t i = 0;
  for (std::uint32_t y = 0; y < square.height; ++y) {
    Row row = ones(square.width);
    for (std::uint32_t x = 0; x < square.width; ++x, ++i) {
      if (!square.is_void.empty() && square.is_void[i] != 0) {
        row &= ~(Row{1} << x);
      } else {
        least_ = std::min(least_, square.heights[i]);
        greatest_ = std::max(greatest_, square.heights[i]);
      }
    }
    has_height_[y] = row;
  }
  heights_ = &heights;
  is_cut_.fill(0);
  falling_.fill(0);
  wanted_.fill({});
  crossed_once_.fill({});
}

void CellLines::find_mixed(std::uint64_t least_above) {
  for (std::uint32_t y = 0; y < square_.height; ++y) {
    const std::uint32_t* const from = &square_.heights[std::size_t{y} * square_.width];
    Row row = 0;
    for (std::uint32_t x = 0; x < square_.width; ++x) row |= Row{from[x] >= least_above} << x;
    above_[y] = row;
  }
  const Row cells = ones(square_.width - 1);
  for (std::uint32_t y = 0; y + 1 < square_.height; ++y) {
    const Row a = above_[y], b = a >> 1, d = above_[y + 1], c = d >> 1;
    mixed_[y] = ((a ^ b) | (a ^ c) | (a ^ d)) & cells;
  }
}

void CellLines::cut_cell(std::uint32_t x, std::uint32_t y) {
  RasterCell cell{};
  for (std::uint32_t number = 0; number < 4; ++number) {
    const std::uint32_t column = x + (number == 1 || number == 2 ? 1 : 0), row = y + (number >> 1);
    const std::uint32_t height = square_.heights[std::size_t{row} * square_.width + column];
    cell.code[number] = heights_->code(height_of_ordered(height, heights_->type));
    cell.has_height[number] = static_cast<std::uint8_t>(has_height_[row] >> column & 1);
  }
  const GridPoint at{square_.first.x + static_cast<std::int32_t>(x),
                     square_.first.y + static_cast<std::int32_t>(y)};
  const Diagonal diagonal = cell_diagonal(cell, at);
  falling_[y] |= Row{diagonal == Diagonal::kFalling} << x;
  const CellTriangles triangles = cell_triangles(diagonal);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [a, b, c] = triangles[i];
    const bool is_surface = (cell.has_height[a] & cell.has_height[b] & cell.has_height[c]) != 0;
    wanted_[y][i] |= Row{is_surface} << x;
  }
  is_cut_[y] |= Row{1} << x;
}

std::size_t CellLines::count_crossed() {
  std::size_t count = 0;
  for (std::uint32_t y = 0; y + 1 < square_.height; ++y) {
    const Row a = above_[y], b = a >> 1, d = above_[y + 1], c = d >> 1;
    const Row falling = falling_[y];
    // A triangle is crossed where a third corner is on another side than one of its other two. Cells that are not
    // cut are not mixed, and none of their triangles is wanted.
    const Row first = (a ^ b) | (falling & (a ^ d)) | (~falling & (a ^ c));
    const Row second = (c ^ d) | (falling & (b ^ c)) | (~falling & (a ^ c));
    crossed_[y] = {first & wanted_[y][0], second & wanted_[y][1]};
    for (std::size_t i = 0; i < 2; ++i) {
      count += static_cast<std::size_t>(std::popcount(crossed_[y][i]));
      crossed_once_[y][i] |= crossed_[y][i];
    }
  }
  return count;
}

std::size_t CellLines::crossed_once() const noexcept {
  std::size_t count = 0;
  for (std::uint32_t y = 0; y + 1 < square_.height; ++y) {
    for (const Row row : crossed_once_[y]) count += static_cast<std::size_t>(std::popcount(row));
  }
  return count;
}

CellLines::Corner CellLines::corner(const At& at, std::uint32_t number) const noexcept {
  const GridPoint p =
      cell_corner({static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y)}, number);
  return {
      {square_.first.x + p.x, square_.first.y + p.y},
      square_
          .heights[static_cast<std::size_t>(p.y) * square_.width + static_cast<std::size_t>(p.x)]};
}

CellLines::At CellLines::entered(std::uint32_t x, std::uint32_t y,
                                 std::uint32_t triangle) const noexcept {
  At at{x, y, triangle, 0, 0};
  const auto& corners = triangle_of(at);
  for (std::size_t i = 0; i < 3; ++i) {
    // Corners come counter-clockwise, so higher ground is on the right of a line that enters by an edge
    // which rises.
    const std::uint8_t from = corners[i], to = corners[i == 2 ? 0 : i + 1];
    if (!is_above(x, y, from) && is_above(x, y, to)) {
      at.below = from;
      at.above = to;
    }
  }
  return at;
}

void CellLines::pass(At& at) const noexcept {
  // Corner numbers of a triangle and the third one make up its sum.
  const auto& corners = triangle_of(at);
  const std::uint32_t third =
      static_cast<std::uint32_t>(corners[0] + corners[1] + corners[2]) - at.below - at.above;
  (is_above(at.x, at.y, third) ? at.above : at.below) = third;
}

bool CellLines::enter_next(At& at) const noexcept {
  switch (4 * at.below + at.above) {
    case 4 * 1 + 0:  // over the lower edge
      if (at.y == 0) return false;
      at = {at.x, at.y - 1, 1, 2, 3};
      return true;
    case 4 * 3 + 2:  // over the upper edge
      if (at.y + 2 >= square_.height) return false;
      at = {at.x, at.y + 1, 0, 0, 1};
      return true;
    case 4 * 2 + 1:  // over the right edge
      if (at.x + 2 >= square_.width) return false;
      at = {at.x + 1, at.y, is_falling(at.x + 1, at.y) ? 0U : 1U, 3, 0};
      return true;
    case 4 * 0 + 3:  // over the left edge
      if (at.x == 0) return false;
      at = {at.x - 1, at.y, is_falling(at.x - 1, at.y) ? 1U : 0U, 1, 2};
      return true;
    default:  // over the diagonal
      at.triangle = 1 - at.triangle;
      return true;
  }
}

}  // namespace ptin
