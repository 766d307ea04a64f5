// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/pixel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/error.h"

namespace ptin::tools {

namespace {

constexpr std::int64_t kMostOnASide = INT32_MAX;

/// Whole numbers in [low, high], as the first and how many there are; that may be 0.
std::array<std::int64_t, 2> whole_numbers_in(double low, double high) {
  // A centre that lies on the border of the window up to rounding, after which on_grid() looks, and up
  // to what decides nothing.
  const double slack = 1e-9;
  const double first = std::ceil(low - slack);
  const double last = std::floor(high + slack);
  if (!(last >= first)) return {0, 0};
  if (last - first >= static_cast<double>(kMostOnASide) || std::abs(first) > 0x1p53) {
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

RasterRequest pixels_in(const std::optional<Window>& window, std::array<double, 2> size,
                        const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  const MapPoint low = facts.map.to_map(b.min_x, b.min_y);
  const MapPoint high = facts.map.to_map(b.max_x, b.max_y);
  const Window w = window.value_or(Window{low.x, low.y, high.x, high.y});
  const GridWindow in_pixels = on_grid(w, {low.x, low.y, size[0], size[1]});
  const auto [first_column, columns] = whole_numbers_in(in_pixels.min_x, in_pixels.max_x);
  const auto [first_row, rows] = whole_numbers_in(in_pixels.min_y, in_pixels.max_y);
  check_pixels(columns, rows, size, w);
  RasterRequest request;
  request.lattice = {low, size[0], -size[1]};
  // Rows count to the south from the corner, so that those of the terrain are negative.
  request.pixels = {first_column, -(first_row + rows - 1), columns, rows};
  return request;
}

std::array<double, 6> geotransform_of(const RasterRequest& request) noexcept {
  const auto& [origin, step_x, step_y, margin] = request.lattice;
  const double west = origin.x + (static_cast<double>(request.pixels.column) - 0.5) * step_x;
  const double north = origin.y + (static_cast<double>(request.pixels.row) - 0.5) * step_y;
  return {west, step_x, 0.0, north, 0.0, step_y};
}

}  // namespace ptin::tools
