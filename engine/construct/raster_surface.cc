// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster_surface.h"

#include <cstdlib>
#include <utility>

namespace ptin {

namespace {

/// floor(i * numerator / denominator) and its remainder for i = 1, 2, ..., without divisions in the
/// loop.
class Stepper {
 public:
  /// REQUIRES: denominator > 0.
  Stepper(std::int64_t numerator, std::int64_t denominator) noexcept
      : denominator_(denominator),
        quotient_step_(numerator / denominator),
        remainder_step_(numerator % denominator) {
    if (remainder_step_ < 0) {
      remainder_step_ += denominator;
      --quotient_step_;
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
  std::int64_t denominator_;
  std::int64_t quotient_step_;
  std::int64_t remainder_step_;
  std::int64_t quotient_ = 0;
  std::int64_t remainder_ = 0;
};

std::int64_t sign(std::int64_t v) noexcept { return v < 0 ? -1 : 1; }

}  // namespace

/// An edge in window coordinates, with the rise of its height relative to its first end.
struct RasterSurface::Line {
  std::int64_t x, y, dx, dy;
  double rise;
};

RasterSurface::RasterSurface(std::vector<HeightBits> heights, std::vector<std::uint8_t> valid,
                             std::int32_t width, std::int32_t height,
                             const HeightEncoding& encoding, GridPoint origin)
    : heights_(std::move(heights)),
      valid_(std::move(valid)),
      width_(width),
      height_(height),
      encoding_(encoding),
      origin_(origin) {}

bool RasterSurface::rises(std::int64_t x, std::int64_t y) const noexcept {
  const std::size_t a = at(x, y);
  const std::size_t d = at(x, y + 1);
  const RasterCell cell{{code(a), code(a + 1), code(d + 1), code(d)},
                        {valid_[a], valid_[a + 1], valid_[d + 1], valid_[d]}};
  const GridPoint corner{static_cast<std::int32_t>(origin_.x + x),
                         static_cast<std::int32_t>(origin_.y + y)};
  return cell_diagonal(cell, corner) == Diagonal::kRising;
}

/// Crossings with the lines x = constant: between two samples of a column, or at a sample.
void RasterSurface::cross_columns(const Line& l, GapMaximum& gap) const {
  const std::int64_t n = std::abs(l.dx);
  const double inverse = n > 0 ? 1.0 / static_cast<double>(n) : 0.0;
  Stepper y(l.dy, n > 0 ? n : 1);
  for (std::int64_t i = 1; i < n; ++i) {
    y.step();
    const std::size_t p = at(l.x + sign(l.dx) * i, l.y + y.floor());
    const std::size_t q = y.remainder() == 0 ? p : p + static_cast<std::size_t>(width_);
    add(p, q, static_cast<double>(y.remainder()) * inverse,
        l.rise * (static_cast<double>(i) * inverse), gap);
  }
}

/// Crossings with the lines y = constant.
void RasterSurface::cross_rows(const Line& l, GapMaximum& gap) const {
  const std::int64_t n = std::abs(l.dy);
  const double inverse = n > 0 ? 1.0 / static_cast<double>(n) : 0.0;
  Stepper x(l.dx, n > 0 ? n : 1);
  for (std::int64_t i = 1; i < n; ++i) {
    x.step();
    const std::size_t p = at(l.x + x.floor(), l.y + sign(l.dy) * i);
    const std::size_t q = x.remainder() == 0 ? p : p + 1;
    add(p, q, static_cast<double>(x.remainder()) * inverse,
        l.rise * (static_cast<double>(i) * inverse), gap);
  }
}

/// Crossings with the lines y - x = constant, where the cell is cut along its rising diagonal.
void RasterSurface::cross_rising(const Line& l, GapMaximum& gap) const {
  const std::int64_t d = l.dy - l.dx;
  const std::int64_t n = std::abs(d);
  const double inverse = n > 0 ? 1.0 / static_cast<double>(n) : 0.0;
  Stepper x(l.dx, n > 0 ? n : 1);
  for (std::int64_t i = 1; i < n; ++i) {
    x.step();
    if (x.remainder() == 0) {
      continue;  // at a sample: a crossing with a row or a column too
    }
    const std::int64_t column = l.x + x.floor();
    const std::int64_t row = column + (l.y - l.x) + sign(d) * i;
    if (rises(column, row)) {
      const std::size_t p = at(column, row);
      add(p, p + static_cast<std::size_t>(width_) + 1, static_cast<double>(x.remainder()) * inverse,
          l.rise * (static_cast<double>(i) * inverse), gap);
    }
  }
}

/// Crossings with the lines y + x = constant, where the cell is cut along its falling diagonal.
void RasterSurface::cross_falling(const Line& l, GapMaximum& gap) const {
  const std::int64_t d = l.dy + l.dx;
  const std::int64_t n = std::abs(d);
  const double inverse = n > 0 ? 1.0 / static_cast<double>(n) : 0.0;
  Stepper x(l.dx, n > 0 ? n : 1);
  for (std::int64_t i = 1; i < n; ++i) {
    x.step();
    if (x.remainder() == 0) {
      continue;
    }
    const std::int64_t column = l.x + x.floor();
    const std::int64_t row = (l.y + l.x) + sign(d) * i - column -
                             1;  // the diagonal's lower right end is (column + 1, row)
    if (!rises(column, row)) {
      const std::size_t upper_left = at(column, row + 1);
      add(upper_left, upper_left + 1 - static_cast<std::size_t>(width_),
          static_cast<double>(x.remainder()) * inverse, l.rise * (static_cast<double>(i) * inverse),
          gap);
    }
  }
}

double RasterSurface::largest_gap(const EdgeEnd& a, const EdgeEnd& b) const {
  const Line line{std::int64_t{a.position.x} - origin_.x, std::int64_t{a.position.y} - origin_.y,
                  std::int64_t{b.position.x} - a.position.x,
                  std::int64_t{b.position.y} - a.position.y, b.code - a.code};
  GapMaximum gap(a.code);
  cross_columns(line, gap);
  cross_rows(line, gap);
  cross_rising(line, gap);
  cross_falling(line, gap);
  return gap.bound();
}

}  // namespace ptin
