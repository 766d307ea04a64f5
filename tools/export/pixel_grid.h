// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raster laid over a terrain: which pixels of one size fit a window.
#pragma once

#include <array>
#include <optional>

#include "engine/query/questions.h"
#include "storage/store_facts.h"

namespace ptin::tools {

/// Asks for the pixels of a size with their centres in a window, columns from the west and rows
/// from the north as in a file. Centres stand at whole multiples of the size from the south-western
/// corner of the box of the terrain's samples, whatever the window is. So rasters of one pixel size
/// fit together, and pixels of the size of the grid's steps have their centres on the samples of a
/// raster source.
/// @param size    Width and height of a pixel, in map units, > 0.
/// @param window  Closed; none means the terrain's box.
/// @throws Error invalid_argument  fewer than two columns or rows of centres lie in the window;
///                                 more than 2^31 - 1 do
[[nodiscard]] RasterRequest pixels_in(const std::optional<Window>& window,
                                      std::array<double, 2> size, const StoreFacts& facts);

/// GDAL's six numbers: the map position of the north-western corner of the raster, and steps.
[[nodiscard]] std::array<double, 6> geotransform_of(const RasterRequest& request) noexcept;

}  // namespace ptin::tools
