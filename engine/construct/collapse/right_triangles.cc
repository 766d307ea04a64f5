// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/right_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "engine/geometry/point.h"

namespace ptin {

namespace {

/// How often a cell is doubled to the square in which the halving begins.
constexpr int kDoublings = 5;
constexpr std::int32_t kSquare = std::int32_t{1} << kDoublings;
/// Corners at multiples of this stay on sides of a window. Whether one between them is needed is
/// decided within 7 samples of it: a corner of squares of side s asks for samples up to s away, and
/// for finer corners up to s away, which ask for less. So kDecidingMargin is enough, and being twice
/// this it leaves the diagonals of squares as they are.
constexpr std::int32_t kKeptOnSides = 8;

/// The part of a window that squares cover.
std::int32_t covered(std::int32_t samples) { return (samples - 1) / kSquare * kSquare; }

/// A row of `count` samples of a triangle, from sample number `first` on. The plane of the triangle
/// has the code `plane` at the first sample, and `step` more at each further one.
struct Row {
  std::size_t first;
  std::int32_t count;
  double plane, step;
};

bool row_is_within(const SampleGrid& grid, const Row& row, double tolerance) {
  const double* codes = &grid.codes[row.first];
  double worst = 0.0;
  for (std::int32_t i = 0; i < row.count; ++i) {
    const double residual = std::abs(codes[i] - (row.plane + row.step * static_cast<double>(i)));
    worst = residual > worst ? residual : worst;
  }
  return worst <= tolerance;
}

/// True when `valid` of all samples of the row is this.
bool row_is_of_class(const SampleGrid& grid, const Row& row, std::uint8_t valid) {
  std::uint8_t others = 0;
  for (std::int32_t i = 0; i < row.count; ++i) {
    others |=
        static_cast<std::uint8_t>(grid.valid[row.first + static_cast<std::size_t>(i)] ^ valid);
  }
  return others == 0;
}

/// A triangle as rows of samples: `rows` of them, at apex.y, apex.y + up and so on. The first goes
/// from column `left` to column `right`; from row to row these move by left_step and right_step.
struct Shape {
  GridPoint apex;
  std::int32_t rows, up;
  std::int32_t left, right, left_step, right_step;
  double slope_x, slope_y;  ///< Slopes of the plane, codes a cell.
};

/// True when all samples of the triangle have a height and residuals within the tolerance, or none
/// has a height.
bool is_within(const SampleGrid& grid, const Shape& shape, double tolerance) {
  const std::size_t at = grid.at(shape.apex.x, shape.apex.y);
  const double apex = grid.codes[at];
  const std::uint8_t valid = grid.valid[at];
  std::int32_t left = shape.left, right = shape.right;
  for (std::int32_t i = 0; i < shape.rows; ++i) {
    const std::int32_t y = shape.apex.y + i * shape.up;
    const double plane = apex + shape.slope_y * static_cast<double>(i * shape.up) +
                         shape.slope_x * static_cast<double>(left - shape.apex.x);
    const Row row{grid.at(left, y), right - left + 1, plane, shape.slope_x};
    if (!row_is_of_class(grid, row, valid) ||
        (valid != 0 && !row_is_within(grid, row, tolerance))) {
      return false;
    }
    left += shape.left_step;
    right += shape.right_step;
  }
  return true;
}

/// Marks corners as not needed, from the finest squares to the coarsest.
class Thinning {
 public:
  /// @param end  Corners in columns and rows below are thinned, but for column and row 0.
  Thinning(const SampleGrid& grid, GridPoint end, double tolerance,
           std::vector<std::uint8_t>& needed)
      : grid_(grid), tolerance_(tolerance), needed_(needed), width_(end.x), height_(end.y) {}

  /// Thins the corners of squares from `first` up to less than `last`.
  void run(std::int32_t first, std::int32_t last) {
    for (std::int32_t side = first; side < last; side *= 2) {
      thin_sides(side);
      thin_centres(side);
    }
  }

 private:
  [[nodiscard]] double code(std::int32_t x, std::int32_t y) const {
    return grid_.codes[grid_.at(x, y)];
  }
  [[nodiscard]] bool is_needed(std::int32_t x, std::int32_t y) const {
    return needed_[grid_.at(x, y)] != 0;
  }
  void thin_sides(std::int32_t side);
  void thin_centres(std::int32_t side);
  [[nodiscard]] bool side_is_free(GridPoint m, std::int32_t side) const;
  [[nodiscard]] bool centre_is_free(GridPoint m, std::int32_t side) const;
  [[nodiscard]] bool holds_row(GridPoint m, std::int32_t side, std::int32_t up) const;
  [[nodiscard]] bool holds_column(GridPoint m, std::int32_t side, std::int32_t right) const;
  [[nodiscard]] bool holds_corner(GridPoint apex, std::int32_t side, std::int32_t right,
                                  std::int32_t up) const;

  const SampleGrid& grid_;
  double tolerance_;
  std::vector<std::uint8_t>& needed_;
  std::int32_t width_, height_;
};

/// Whether a triangle is within the tolerance: its hypotenuse goes along the row from (m.x - side,
/// m.y) to (m.x + side, m.y), and its apex lies `side` rows above (`up` is 1) or below (-1).
bool Thinning::holds_row(GridPoint m, std::int32_t side, std::int32_t up) const {
  const std::int32_t y = m.y + up * side;
  const double west = code(m.x - side, m.y), east = code(m.x + side, m.y);
  const double across = (east - west) / (2.0 * side);
  const double along = ((west + east) / 2.0 - code(m.x, y)) / (-up * static_cast<double>(side));
  return is_within(grid_, {{m.x, y}, side + 1, -up, m.x, m.x, -1, 1, across, along}, tolerance_);
}

/// The same with the hypotenuse along the column from (m.x, m.y - side) to (m.x, m.y + side), and
/// the apex to the east (`right` is 1) or west (-1). Two halves, from the row of the apex.
bool Thinning::holds_column(GridPoint m, std::int32_t side, std::int32_t right) const {
  const std::int32_t x = m.x + right * side;
  const double south = code(m.x, m.y - side), north = code(m.x, m.y + side);
  const double along = (north - south) / (2.0 * side);
  const double across =
      ((south + north) / 2.0 - code(x, m.y)) / (-right * static_cast<double>(side));
  const auto half = [&](std::int32_t up) {
    return right > 0 ? Shape{{x, m.y}, side + 1, up, m.x, x, 0, -1, across, along}
                     : Shape{{x, m.y}, side + 1, up, x, m.x, 1, 0, across, along};
  };
  return is_within(grid_, half(1), tolerance_) && is_within(grid_, half(-1), tolerance_);
}

/// The same for half of a square of 2 * side with its right angle at `apex`: its legs go east or
/// west (`right`) and north or south (`up`).
bool Thinning::holds_corner(GridPoint apex, std::int32_t side, std::int32_t right,
                            std::int32_t up) const {
  const std::int32_t length = 2 * side;
  const std::int32_t x = apex.x + right * length;
  const double z = code(apex.x, apex.y);
  const double across = (code(x, apex.y) - z) / (right * static_cast<double>(length));
  const double along =
      (code(apex.x, apex.y + up * length) - z) / (up * static_cast<double>(length));
  const Shape shape = right > 0 ? Shape{apex, length + 1, up, apex.x, x, 0, -1, across, along}
                                : Shape{apex, length + 1, up, x, apex.x, 1, 0, across, along};
  return is_within(grid_, shape, tolerance_);
}

/// Whether the middle m of a hypotenuse along a row or a column can go: no smaller triangle needs
/// it, and the triangles on both sides are within the tolerance.
bool Thinning::side_is_free(GridPoint m, std::int32_t side) const {
  if (side > 1) {
    const std::int32_t h = side / 2;
    if (is_needed(m.x - h, m.y - h) || is_needed(m.x + h, m.y - h) || is_needed(m.x - h, m.y + h) ||
        is_needed(m.x + h, m.y + h)) {
      return false;
    }
  }
  if ((m.x / side) % 2 != 0) {
    return holds_row(m, side, 1) && holds_row(m, side, -1);
  }
  return holds_column(m, side, 1) && holds_column(m, side, -1);
}

/// The same for the middle of a square of 2 * side. The diagonal of the square joins the two
/// corners whose column and row, counted in such squares, have an even sum.
bool Thinning::centre_is_free(GridPoint m, std::int32_t side) const {
  if (is_needed(m.x - side, m.y) || is_needed(m.x + side, m.y) || is_needed(m.x, m.y - side) ||
      is_needed(m.x, m.y + side)) {
    return false;
  }
  const std::int32_t x0 = m.x - side, y0 = m.y - side, x1 = m.x + side, y1 = m.y + side;
  if ((x0 / (2 * side) + y0 / (2 * side)) % 2 == 0) {
    return holds_corner({x1, y0}, side, -1, 1) && holds_corner({x0, y1}, side, 1, -1);
  }
  return holds_corner({x0, y0}, side, 1, 1) && holds_corner({x1, y1}, side, -1, -1);
}

void Thinning::thin_sides(std::int32_t side) {
  for (std::int32_t y = 1; y < height_; ++y) {
    if (y % side != 0) {
      continue;
    }
    const std::int32_t first = (y / side) % 2 != 0 ? 2 * side : side;
    for (std::int32_t x = first; x < width_; x += 2 * side) {
      if (side_is_free({x, y}, side)) {
        needed_[grid_.at(x, y)] = 0;
      }
    }
  }
}

void Thinning::thin_centres(std::int32_t side) {
  for (std::int32_t y = side; y < height_; y += 2 * side) {
    for (std::int32_t x = side; x < width_; x += 2 * side) {
      if (centre_is_free({x, y}, side)) {
        needed_[grid_.at(x, y)] = 0;
      }
    }
  }
}

/// Halves triangles from the squares down as far as corners are needed.
class Halving {
 public:
  Halving(const SampleGrid& grid, std::span<const std::uint8_t> needed)
      : grid_(grid), needed_(needed), other_half_(grid.codes.size(), 0) {}

  std::vector<RightTriangle> run();

 private:
  /// Adds the triangle with the right angle at `apex`, or its halves where the middle of its
  /// hypotenuse from a to b is needed. `apex`, `a` and `b` are counter-clockwise.
  void add(GridPoint apex, GridPoint a, GridPoint b);
  void add_half_cell(GridPoint apex, GridPoint a, GridPoint b);
  void add_square(GridPoint corner);
  void add_cell(std::int32_t x, std::int32_t y);
  [[nodiscard]] std::array<RightTriangle, 2> halves(std::int32_t x, std::int32_t y) const;
  [[nodiscard]] std::uint32_t number(GridPoint p) const {
    return static_cast<std::uint32_t>(grid_.at(p.x, p.y));
  }

  const SampleGrid& grid_;
  std::span<const std::uint8_t> needed_;
  std::vector<std::uint32_t> other_half_;  ///< 1 + each cell's half in triangles_; or 0.
  std::vector<RightTriangle> triangles_;
};

/// The halves of a cell as the full TIN has them.
std::array<RightTriangle, 2> Halving::halves(std::int32_t x, std::int32_t y) const {
  const std::uint32_t a = number({x, y}), b = a + 1, d = number({x, y + 1}), c = d + 1;
  if (grid_.rising[a] != 0) {
    return {RightTriangle{a, b, c}, RightTriangle{a, c, d}};
  }
  return {RightTriangle{a, b, d}, RightTriangle{b, c, d}};
}

void Halving::add_cell(std::int32_t x, std::int32_t y) {
  const auto both = halves(x, y);
  triangles_.insert(triangles_.end(), both.begin(), both.end());
}

void Halving::add_half_cell(GridPoint apex, GridPoint a, GridPoint b) {
  const std::int32_t x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  std::uint32_t& other = other_half_[grid_.at(x, y)];
  if (other == 0) {
    triangles_.push_back({number(apex), number(a), number(b)});
    other = static_cast<std::uint32_t>(triangles_.size());
    return;
  }
  const auto both = halves(x, y);
  triangles_[other - 1] = both[0];
  triangles_.push_back(both[1]);
}

void Halving::add(GridPoint apex, GridPoint a, GridPoint b) {
  if (std::abs(a.x - b.x) == 1) {
    add_half_cell(apex, a, b);
    return;
  }
  const GridPoint middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
  if (needed_[grid_.at(middle.x, middle.y)] == 0) {
    triangles_.push_back({number(apex), number(a), number(b)});
    return;
  }
  add(middle, apex, a);
  add(middle, b, apex);
}

void Halving::add_square(GridPoint corner) {
  const GridPoint a = corner, b{a.x + kSquare, a.y}, c{b.x, a.y + kSquare}, d{a.x, c.y};
  const GridPoint centre{a.x + kSquare / 2, a.y + kSquare / 2};
  if (needed_[grid_.at(centre.x, centre.y)] != 0) {
    add(centre, a, b);
    add(centre, b, c);
    add(centre, c, d);
    add(centre, d, a);
  } else if ((a.x / kSquare + a.y / kSquare) % 2 == 0) {
    add(b, c, a);
    add(d, a, c);
  } else {
    add(a, b, d);
    add(c, d, b);
  }
}

std::vector<RightTriangle> Halving::run() {
  const std::int32_t width = covered(grid_.width), height = covered(grid_.height);
  for (std::int32_t y = 0; y < height; y += kSquare) {
    for (std::int32_t x = 0; x < width; x += kSquare) {
      add_square({x, y});
    }
  }
  for (std::int32_t y = 0; y + 1 < grid_.height; ++y) {
    for (std::int32_t x = y < height ? width : 0; x + 1 < grid_.width; ++x) {
      add_cell(x, y);
    }
  }
  return std::move(triangles_);
}

}  // namespace

namespace {

/// Where thinning ends along one axis: where the window's squares end, if that is before its side;
/// else with the last whole square of kKeptOnSides.
std::int32_t end_of_thinning(std::int32_t window, std::int32_t before, std::int32_t around) {
  return covered(window) < window - 1 ? before + covered(window)
                                      : (around - 1) / kKeptOnSides * kKeptOnSides;
}

}  // namespace

std::vector<std::uint8_t> needed_corners(const SurroundedGrid& grid, double tolerance) {
  const SampleGrid& window = grid.window;
  const SampleGrid& around = grid.around;
  std::vector<std::uint8_t> finest(around.codes.size(), 1);
  const GridPoint end{end_of_thinning(window.width, grid.x, around.width),
                      end_of_thinning(window.height, grid.y, around.height)};
  Thinning(around, end, tolerance, finest).run(1, kKeptOnSides);
  std::vector<std::uint8_t> needed(window.codes.size());
  for (std::int32_t y = 0; y < window.height; ++y) {
    std::copy_n(&finest[around.at(grid.x, grid.y + y)], window.width, &needed[window.at(0, y)]);
  }
  Thinning(window, {covered(window.width), covered(window.height)}, tolerance, needed)
      .run(kKeptOnSides, kSquare);
  return needed;
}

std::vector<RightTriangle> right_triangles(const SampleGrid& grid,
                                           std::span<const std::uint8_t> needed) {
  return Halving(grid, needed).run();
}

}  // namespace ptin
