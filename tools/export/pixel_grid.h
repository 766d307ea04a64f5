// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raster laid over a terrain, and the TIN sampled at the centres of its pixels, exactly.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/terrain.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// Pixels, columns from the west and rows from the north as in a file.
struct PixelRect {
  std::int64_t column = 0, row = 0, width = 0, height = 0;
  [[nodiscard]] std::int64_t pixels() const noexcept { return width * height; }
};

/// Pixel centres stand at whole multiples of the pixel's size from the terrain's south-western
/// corner (of the box of its samples), whatever the window: so rasters of one pixel size fit
/// together, and with the size of the grid's step the centres are the samples of a raster source.
///
/// Positions on the grid are rounded to 2^-20 grid units; from there on everything is exact.
class PixelGrid {
 public:
  /// @param size    Of a pixel, in map units, > 0.
  /// @param window  Its centres alone (closed); none takes the terrain's whole box.
  /// @throws Error invalid_argument  no centre lies in the window; more than 2^31 - 1 columns or
  /// rows
  PixelGrid(const StoreFacts& facts, std::array<double, 2> size,
            const std::optional<Window>& window);

  [[nodiscard]] std::int64_t columns() const noexcept { return columns_; }
  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  /// As GDAL wants it: the map position of the north-western corner, and steps.
  [[nodiscard]] std::array<double, 6> geotransform() const noexcept;
  /// Centre of a column or row, in 2^-20 grid units.
  [[nodiscard]] std::int64_t x(std::int64_t column) const noexcept;
  [[nodiscard]] std::int64_t y(std::int64_t row) const noexcept;
  /// The grid box around the centres of `rect`, closed, clipped to the grid.
  [[nodiscard]] GridBox box(const PixelRect& rect) const noexcept;

 private:
  const StoreFacts& facts_;
  std::array<double, 2> size_;                     ///< Map units.
  std::array<double, 2> pitch_;                    ///< Grid units.
  std::int64_t first_column_ = 0, first_row_ = 0;  ///< In pixels from the corner; south-most row.
  std::int64_t columns_ = 0, rows_ = 0;
};

/// Writes the height of each pixel centre of `part` that lies in a closed surface triangle of
/// `refined` to its place in `heights`, which holds the pixels of `rect` row by row from the north;
/// leaves the others alone. A centre on a vertex gets the vertex's height, one on an edge is
/// interpolated along the edge alone: so the value does not depend on which triangle is asked, nor
/// on the part. Weights are exact; the height is rounded where it is formed.
/// @param part  Inside of `rect`.  Cost: triangles, and pixels under them.
void sample_tin(const RefinedTin& refined, const StoreFacts& facts, const PixelGrid& grid,
                const PixelRect& part, const PixelRect& rect, std::vector<double>& heights);

}  // namespace ptin::tools
