// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/grid_cell.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/geometry/hilbert.h"
#include "engine/query/shape/tiler.h"

namespace ptin {

namespace {

GridCell smallest_cell_around(const GridBox& domain) {
  const auto differing = static_cast<std::uint32_t>(domain.min_x ^ domain.max_x) |
                         static_cast<std::uint32_t>(domain.min_y ^ domain.max_y);
  const int level = std::bit_width(differing);
  return {static_cast<std::uint32_t>(domain.min_x) >> level << level,
          static_cast<std::uint32_t>(domain.min_y) >> level << level, level};
}

/// Positions that the boxes share. REQUIRES: they meet.
double shared_area(const GridBox& a, const GridBox& b) {
  const double width = std::min(a.max_x, b.max_x) - std::max(a.min_x, b.min_x);
  const double height = std::min(a.max_y, b.max_y) - std::max(a.min_y, b.min_y);
  return (width + 1.0) * (height + 1.0);
}

}  // namespace

GridBox GridCell::box() const noexcept {
  const auto last = [this](std::uint32_t first) {
    const std::uint64_t end = std::uint64_t{first} + (std::uint64_t{1} << level) - 1;
    return static_cast<std::int32_t>(std::min<std::uint64_t>(end, kGridMax));
  };
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), last(x), last(y)};
}

std::uint64_t position_along(const GridBox& box) noexcept {
  const auto middle = [](std::int32_t low, std::int32_t high) {
    return static_cast<std::uint32_t>(
        std::clamp<std::int64_t>((std::int64_t{low} + high) / 2, 0, kGridMax));
  };
  return hilbert_position(middle(box.min_x, box.max_x), middle(box.min_y, box.max_y));
}

std::array<GridCell, 4> divided(const GridCell& cell) {
  const int level = cell.level - 1;
  const std::uint32_t side = 1U << level;
  std::array<GridCell, 4> cells = {{{cell.x, cell.y, level},
                                    {cell.x + side, cell.y, level},
                                    {cell.x, cell.y + side, level},
                                    {cell.x + side, cell.y + side, level}}};
  std::sort(cells.begin(), cells.end(), [](const GridCell& a, const GridCell& b) {
    return hilbert_position(a.x, a.y) < hilbert_position(b.x, b.y);
  });
  return cells;
}

void work_on_cells(const GridBox& domain, const WorkOnCell& work) {
  const GridCell whole = smallest_cell_around(domain);
  const double area = shared_area(domain, domain);
  double done = 0.0;
  work_in_parts(whole, [&](const GridCell& cell) {
    const GridBox box = cell.box();
    if (!meets(box, domain)) return true;
    const double share = std::ldexp(1.0, 2 * (cell.level - whole.level));
    const double done_then = done + shared_area(box, domain);
    if (!work(cell, share, area > 0 ? std::min(1.0, done_then / area) : 1.0)) return false;
    done = done_then;
    return true;
  });
}

}  // namespace ptin
