// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pixels of the raster that a terrain was built from.
#pragma once

#include <array>

#include "storage/store_file.h"

namespace ptin::tools {

/// Their width and height, map units: the grid's steps, where the samples fill the grid.
/// @throws Error invalid_argument  it was built from points or a TIN: asks for --pixel-size
///               corruption        the metadata holds no counts
[[nodiscard]] std::array<double, 2> own_pixel_size(const StoreFile& store);

}  // namespace ptin::tools
