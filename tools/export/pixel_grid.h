// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raster laid over a terrain: where the centres of its pixels stand.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/query/terrain.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// Pixels, columns from the west and rows from the north as in a file.
struct PixelRect {
  std::int64_t column = 0, row = 0, width = 0, height = 0;
  [[nodiscard]] std::int64_t pixels() const noexcept { return width * height; }
};

/// A grid of pixels. Their centres stand at whole multiples of the pixel's size from the
/// south-western corner of the box of the terrain's samples, whatever the window is. So rasters of
/// one pixel size fit together, and pixels of the size of the grid's steps have their centres on
/// the samples of a raster source.
///
/// Positions on the grid are rounded to 2^-20 grid units; from there on everything is exact.
class PixelGrid {
 public:
  static constexpr int kLatticeBits = 20;  ///< Positions are whole multiples of 2^-20.

  /// @param facts   Of the terrain; borrowed for the life of the grid.
  /// @param size    Width and height of a pixel, in map units, > 0.
  /// @param window  Only pixels with their centres in this closed window; none means the terrain's
  ///                box.
  /// @throws Error invalid_argument  fewer than two columns or rows of centres lie in the window;
  ///                                 more than 2^31 - 1 do
  PixelGrid(const StoreFacts& facts, std::array<double, 2> size,
            const std::optional<Window>& window);

  [[nodiscard]] std::int64_t columns() const noexcept { return columns_; }
  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  /// GDAL's six numbers: the map position of the north-western corner of the raster, and steps.
  [[nodiscard]] std::array<double, 6> geotransform() const noexcept;
  /// The centre of a column or row, in units of 2^-20 grid units.
  [[nodiscard]] std::int64_t x(std::int64_t column) const noexcept;
  [[nodiscard]] std::int64_t y(std::int64_t row) const noexcept;
  /// The centre of a pixel, in map units.
  [[nodiscard]] MapPoint centre(std::int64_t column, std::int64_t row) const noexcept;
  /// The grid box around the centres of `rect`, closed, clipped to the grid.
  [[nodiscard]] GridBox box(const PixelRect& rect) const noexcept;

 private:
  const StoreFacts& facts_;
  std::array<double, 2> size_;                     ///< Map units.
  std::array<double, 2> pitch_;                    ///< Grid units.
  std::int64_t first_column_ = 0, first_row_ = 0;  ///< In pixels from the corner.
  std::int64_t columns_ = 0, rows_ = 0;
};

}  // namespace ptin::tools
