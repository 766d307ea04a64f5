// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/pixel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/error.h"

namespace ptin::tools {

namespace {

constexpr double kLattice = 1048576.0;  // 2^20
constexpr std::int64_t kMostPixels = INT32_MAX;

/// Whole numbers in [low, high], as the first and how many there are; that may be 0.
std::array<std::int64_t, 2> whole_numbers_in(double low, double high) {
  // A centre that lies on the border of the window up to rounding, after which on_grid() looks, and up
  // to what decides nothing.
  const double slack = 1e-9;
  const double first = std::ceil(low - slack);
  const double last = std::floor(high + slack);
  if (!(last >= first)) return {0, 0};
  if (last - first >= static_cast<double>(kMostPixels) || std::abs(first) > 0x1p53) {
    throw Error(ErrorCode::invalid_argument,
                "the raster would have more than 2^31 columns or rows; give a larger --pixel-size");
  }
  return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last - first) + 1};
}

/// Refuses what nobody means by a raster: pixels so large that one of them covers the window, as of
/// metres where the map unit is the degree.
void check_pixels(std::int64_t columns, std::int64_t rows, std::array<double, 2> size,
                  const Window& window) {
  if (columns >= 2 && rows >= 2) return;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "%lld x %lld pixels of %.10g x %.10g map units fit the window of %.10g x %.10g, and "
      "a raster has 2 x 2 at least; give a smaller size (over ground as 90m), or a larger "
      "window",
      static_cast<long long>(columns), static_cast<long long>(rows), size[0], size[1],
      window.max_x - window.min_x, window.max_y - window.min_y);
  throw Error(ErrorCode::invalid_argument, text.data(), "--pixel-size");
}

}  // namespace

PixelGrid::PixelGrid(const StoreFacts& facts, std::array<double, 2> size,
                     const std::optional<Window>& window)
    : facts_(facts), size_(size), pitch_{size[0] / facts.map.step_x, size[1] / facts.map.step_y} {
  const GridBox& b = facts.bounds;
  const MapPoint low = facts.map.to_map(b.min_x, b.min_y);
  const MapPoint high = facts.map.to_map(b.max_x, b.max_y);
  const Window w = window.value_or(Window{low.x, low.y, high.x, high.y});
  const GridWindow in_pixels = on_grid(w, {low.x, low.y, size_[0], size_[1]});
  const auto across = whole_numbers_in(in_pixels.min_x, in_pixels.max_x);
  const auto up = whole_numbers_in(in_pixels.min_y, in_pixels.max_y);
  first_column_ = across[0];
  columns_ = across[1];
  first_row_ = up[0];
  rows_ = up[1];
  check_pixels(columns_, rows_, size_, w);
}

std::array<double, 6> PixelGrid::geotransform() const noexcept {
  const MapPoint corner = facts_.map.to_map(facts_.bounds.min_x, facts_.bounds.min_y);
  const double west = corner.x + (static_cast<double>(first_column_) - 0.5) * size_[0];
  const double north = corner.y + (static_cast<double>(first_row_ + rows_) - 0.5) * size_[1];
  return {west, size_[0], 0.0, north, 0.0, -size_[1]};
}

std::int64_t PixelGrid::x(std::int64_t column) const noexcept {
  const double at = facts_.bounds.min_x + static_cast<double>(first_column_ + column) * pitch_[0];
  return std::llround(std::clamp(at, -0x1p31, 0x1p31) * kLattice);
}

std::int64_t PixelGrid::y(std::int64_t row) const noexcept {
  const auto up = static_cast<double>(first_row_ + rows_ - 1 - row);
  const double at = facts_.bounds.min_y + up * pitch_[1];
  return std::llround(std::clamp(at, -0x1p31, 0x1p31) * kLattice);
}

MapPoint PixelGrid::centre(std::int64_t column, std::int64_t row) const noexcept {
  const double lattice = 1 / kLattice;
  return facts_.map.to_map(static_cast<double>(x(column)) * lattice,
                           static_cast<double>(y(row)) * lattice);
}

GridBox PixelGrid::box(const PixelRect& rect) const noexcept {
  const auto down = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v >> kLatticeBits, -1, kGridMax + 1));
  };
  const auto up = [&](std::int64_t v) { return down(v + (std::int64_t{1} << kLatticeBits) - 1); };
  return {down(x(rect.column)), down(y(rect.row + rect.height - 1)),
          up(x(rect.column + rect.width - 1)), up(y(rect.row))};
}

}  // namespace ptin::tools
