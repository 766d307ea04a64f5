// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pixels of the raster that a terrain was built from.
#pragma once

#include <array>

#include "storage/store_file.h"

namespace ptin::tools {

/// Width and height of the pixels of the raster that a terrain was built from, in map units: the
/// steps of the grid.
/// @throws Error invalid_argument  samples do not fill the grid, so the terrain was built from
///                                 points or a TIN; asks for --pixel-size
/// @throws Error corruption  the counts in the metadata are no counts
[[nodiscard]] std::array<double, 2> own_pixel_size(const StoreFile& store);

}  // namespace ptin::tools
