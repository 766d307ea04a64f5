// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_surface.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// floor(i * numerator / denominator) and its remainder for i = first, first + 1, ..., without
/// divisions in the loop. Products stay below 2^62: numerator and i are lengths on the grid.
class Stepper {
 public:
  /// REQUIRES: denominator > 0. step() comes before the first value.
  Stepper(std::int64_t numerator, std::int64_t denominator, std::int64_t first) noexcept
      : denominator_(denominator) {
    divide(numerator, quotient_step_, remainder_step_);
    if (first != 1) {
      divide(numerator * (first - 1), quotient_, remainder_);
    }
  }
  void step() noexcept {
    quotient_ += quotient_step_;
    remainder_ += remainder_step_;
    if (remainder_ >= denominator_) {
      remainder_ -= denominator_;
      ++quotient_;
    }
  }
  [[nodiscard]] std::int64_t floor() const noexcept { return quotient_; }
  [[nodiscard]] std::int64_t remainder() const noexcept { return remainder_; }

 private:
  void divide(std::int64_t n, std::int64_t& quotient, std::int64_t& remainder) const noexcept {
    quotient = n / denominator_;
    remainder = n % denominator_;
    if (remainder < 0) {
      remainder += denominator_;
      --quotient;
    }
  }
  std::int64_t denominator_;
  std::int64_t quotient_step_ = 0;
  std::int64_t remainder_step_ = 0;
  std::int64_t quotient_ = 0;
  std::int64_t remainder_ = 0;
};

/// Where an edge crosses one of a family of lines.
struct Crossing {
  std::int64_t steps;  ///< From the edge's first end, across the lines.
  std::int64_t floor;  ///< How far it is from there in x, or in y, rounded down.
  bool is_whole;       ///< Nothing was rounded.
  double fraction;     ///< The part that was rounded away.
  double rise;         ///< The edge's height there, above its first end.
};

}  // namespace

/// An edge in window coordinates, with the rise of its height relative to its first end, and the
/// part of it, as fractions, that may lie in the window.
struct RasterSurface::Line {
  std::int64_t x, y, dx, dy;
  double rise;
  double enter = 0.0, leave = 1.0;

  /// Crossings 1 .. n - 1 with a family of lines divide the edge into n equal parts; first(n) ..
  /// end(n) - 1 hold all that may lie in the window, and a few more.
  [[nodiscard]] std::int64_t first(std::int64_t n) const noexcept {
    return enter <= 0.0 ? 1
                        : std::max<std::int64_t>(
                              static_cast<std::int64_t>(enter * static_cast<double>(n)) - 1, 1);
  }
  [[nodiscard]] std::int64_t end(std::int64_t n) const noexcept {
    return leave >= 1.0 ? n
                        : std::min<std::int64_t>(
                              static_cast<std::int64_t>(leave * static_cast<double>(n)) + 2, n);
  }
  /// Narrows [enter, leave] to where one coordinate, which goes from `from` to `from` + `length`
  /// along the edge, is within 0 .. size - 1.
  void clip(std::int64_t from, std::int64_t length, std::int64_t size) noexcept {
    if (length == 0) {
      leave = from < 0 || from >= size ? -1.0 : leave;
      return;
    }
    const double a = static_cast<double>(-from) / static_cast<double>(length);
    const double b = static_cast<double>(size - 1 - from) / static_cast<double>(length);
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  /// Calls take(crossing) for those that may lie in the window.
  /// @param across  From the first end to the last, across the lines: their crossings divide it.
  /// @param length  Likewise, in the coordinate that is divided along with it.
  template <class Take>
  void visit(std::int64_t across, std::int64_t length, const Take& take) const {
    const std::int64_t n = std::abs(across);
    if (n < 2) {
      return;
    }
    const double inverse = 1.0 / static_cast<double>(n);
    Stepper at(length, n, first(n));
    for (std::int64_t i = first(n); i < end(n); ++i) {
      at.step();
      take(Crossing{across < 0 ? -i : i, at.floor(), at.remainder() == 0,
                    static_cast<double>(at.remainder()) * inverse,
                    rise * (static_cast<double>(i) * inverse)});
    }
  }
};

RasterSurface::RasterSurface(std::vector<HeightBits> heights, std::vector<std::uint8_t> valid,
                             const SampleRange& window, const HeightEncoding& encoding)
    : heights_(std::move(heights)),
      flags_(std::move(valid)),
      width_(static_cast<std::int32_t>(window.width)),
      height_(static_cast<std::int32_t>(window.height)),
      encoding_(encoding),
      origin_{static_cast<std::int32_t>(window.x0), static_cast<std::int32_t>(window.y0)} {
  for (std::uint8_t& flags : flags_) {
    flags = flags != 0 ? kValid : 0;
  }
  mark_rising();
}

/// Finds the diagonals of all cells once, since each is asked for many times.
void RasterSurface::mark_rising() {
  const auto valid = [this](std::size_t i) {
    return static_cast<std::uint8_t>(flags_[i] & kValid);
  };
  for (std::int32_t y = 0; y + 1 < height_; ++y) {
    for (std::int32_t x = 0; x + 1 < width_; ++x) {
      const std::size_t a = at(x, y);
      const std::size_t d = at(x, y + 1);
      const RasterCell cell{{code(a), code(a + 1), code(d + 1), code(d)},
                            {valid(a), valid(a + 1), valid(d + 1), valid(d)}};
      if (cell_diagonal(cell, {origin_.x + x, origin_.y + y}) == Diagonal::kRising) {
        flags_[a] |= kRises;
      }
    }
  }
}

/// Crossings with the lines x = constant: between two samples of a column, or at a sample.
void RasterSurface::cross_columns(const Line& l, GapMaximum& gap) const {
  l.visit(l.dx, l.dy, [&](const Crossing& c) {
    const std::int64_t column = l.x + c.steps, row = l.y + c.floor;
    if (!holds(column, row) || (!c.is_whole && row + 1 == height_)) {
      return;
    }
    const std::size_t p = at(column, row);
    add(p, c.is_whole ? p : p + static_cast<std::size_t>(width_), c.fraction, c.rise, gap);
  });
}

/// Crossings with the lines y = constant.
void RasterSurface::cross_rows(const Line& l, GapMaximum& gap) const {
  l.visit(l.dy, l.dx, [&](const Crossing& c) {
    const std::int64_t column = l.x + c.floor, row = l.y + c.steps;
    if (!holds(column, row) || (!c.is_whole && column + 1 == width_)) {
      return;
    }
    const std::size_t p = at(column, row);
    add(p, c.is_whole ? p : p + 1, c.fraction, c.rise, gap);
  });
}

/// Crossings with the lines y - x = constant, where the cell is cut along its rising diagonal. Those
/// at a sample are crossings with a row or a column too.
void RasterSurface::cross_rising(const Line& l, GapMaximum& gap) const {
  l.visit(l.dy - l.dx, l.dx, [&](const Crossing& c) {
    const std::int64_t column = l.x + c.floor, row = column + (l.y - l.x) + c.steps;
    if (!c.is_whole && holds(column, row) && holds(column + 1, row + 1) && rises(column, row)) {
      const std::size_t p = at(column, row);
      add(p, p + static_cast<std::size_t>(width_) + 1, c.fraction, c.rise, gap);
    }
  });
}

/// Crossings with the lines y + x = constant, where the cell is cut along its falling diagonal.
void RasterSurface::cross_falling(const Line& l, GapMaximum& gap) const {
  l.visit(l.dy + l.dx, l.dx, [&](const Crossing& c) {
    const std::int64_t column = l.x + c.floor;
    // The diagonal's lower right end is (column + 1, row).
    const std::int64_t row = (l.y + l.x) + c.steps - column - 1;
    if (!c.is_whole && holds(column, row) && holds(column + 1, row + 1) && !rises(column, row)) {
      const std::size_t p = at(column, row + 1);
      add(p, p + 1 - static_cast<std::size_t>(width_), c.fraction, c.rise, gap);
    }
  });
}

RasterSurface::Line RasterSurface::line_of(const EdgeEnd& a, const EdgeEnd& b) const noexcept {
  Line line{std::int64_t{a.position.x} - origin_.x, std::int64_t{a.position.y} - origin_.y,
            std::int64_t{b.position.x} - a.position.x, std::int64_t{b.position.y} - a.position.y,
            b.code - a.code};
  if (!holds(line.x, line.y) || !holds(line.x + line.dx, line.y + line.dy)) {
    line.clip(line.x, line.dx, width_);
    line.clip(line.y, line.dy, height_);
  }
  return line;
}

double RasterSurface::border_move(GridPoint a, GridPoint b) const {
  if (border_ != nullptr) {
    return border_->border_move(a, b);
  }
  if (!far_from_border_) {
    return 0.0;
  }
  Line line = line_of({a, 0.0}, {b, 0.0});
  line.clip(line.x, line.dx, width_);
  line.clip(line.y, line.dy, height_);
  if (line.enter >= line.leave) {
    return 0.0;
  }
  // Along a side of the window it crosses no triangle of it.
  const double middle = (line.enter + line.leave) / 2.0;
  const double x = static_cast<double>(line.x) + static_cast<double>(line.dx) * middle;
  const double y = static_cast<double>(line.y) + static_cast<double>(line.dy) * middle;
  const bool is_inside = x > 0.0 && y > 0.0 && x < width_ - 1.0 && y < height_ - 1.0;
  return is_inside ? kInfinity : 0.0;
}

double RasterSurface::largest_gap(const EdgeEnd& a, const EdgeEnd& b) const {
  const Line line = line_of(a, b);
  GapMaximum gap(a.code);
  if (line.enter > line.leave) {
    return 0.0;
  }
  cross_columns(line, gap);
  cross_rows(line, gap);
  cross_rising(line, gap);
  cross_falling(line, gap);
  return gap.bound();
}

}  // namespace ptin
