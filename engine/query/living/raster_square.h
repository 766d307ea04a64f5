// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples of a raster side by side: cells of the full TIN before they are triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/geometry/point.h"

namespace ptin {

/// The samples of a rectangle, row by row from the lower left one. Borrowed. Its cells have the diagonals
/// of mesh/raster_cell.h.
struct RasterSquare {
  GridPoint first;
  std::uint32_t width = 0, height = 0;     ///< Samples.
  std::span<const std::uint32_t> heights;  ///< Ordered (storage/page_columns.h); of void ones any.
  std::span<const std::uint8_t> is_void;   ///< Empty: none is.
};

}  // namespace ptin
