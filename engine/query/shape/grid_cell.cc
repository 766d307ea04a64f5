// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/grid_cell.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/geometry/hilbert.h"

namespace ptin {

namespace {

/// The walk over the quadtree of cells.
class CellWalk {
 public:
  CellWalk(const GridBox& domain, const CellFits& fits, const VisitCell& visit)
      : domain_(domain), fits_(fits), visit_(visit), area_(area_in(domain)) {}

  void run() {
    const auto differing = static_cast<std::uint32_t>(domain_.min_x ^ domain_.max_x) |
                           static_cast<std::uint32_t>(domain_.min_y ^ domain_.max_y);
    const int level = std::bit_width(differing);
    const auto x = static_cast<std::uint32_t>(domain_.min_x) >> level << level;
    const auto y = static_cast<std::uint32_t>(domain_.min_y) >> level << level;
    go_through({x, y, level}, 1.0);
  }

 private:
  void go_through(const GridCell& cell, double share) {
    const GridBox box = cell.box();
    if (!meets(box, domain_)) return;
    if (cell.level > 0 && !fits_(cell, share)) {
      for (const GridCell& child : children(cell)) go_through(child, share / 4);
      return;
    }
    done_ += area_in(box);
    visit_(cell, area_ > 0 ? std::min(1.0, done_ / area_) : 1.0);
  }

  [[nodiscard]] double area_in(const GridBox& box) const {
    const double width = std::min(box.max_x, domain_.max_x) - std::max(box.min_x, domain_.min_x);
    const double height = std::min(box.max_y, domain_.max_y) - std::max(box.min_y, domain_.min_y);
    return (width + 1.0) * (height + 1.0);
  }

  static std::array<GridCell, 4> children(const GridCell& cell) {
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

  GridBox domain_;
  const CellFits& fits_;
  const VisitCell& visit_;
  double area_ = 0.0;
  double done_ = 0.0;
};

}  // namespace

GridBox GridCell::box() const noexcept {
  const auto last = [this](std::uint32_t first) {
    const std::uint64_t end = std::uint64_t{first} + (std::uint64_t{1} << level) - 1;
    return static_cast<std::int32_t>(std::min<std::uint64_t>(end, kGridMax));
  };
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), last(x), last(y)};
}

void walk_fitting_cells(const GridBox& domain, const CellFits& fits, const VisitCell& visit) {
  CellWalk(domain, fits, visit).run();
}

}  // namespace ptin
