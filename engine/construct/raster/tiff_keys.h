// SPDX-License-Identifier: GPL-3.0-or-later
//
// The GeoTIFF keys of a TIFF file, as they are.
#pragma once

#include <string>

#include "engine/construct/grid/geotiff_keys.h"

namespace ptin {

/// The keys in the first directory of a TIFF, of 32 or of 64 bits and of either byte order; empty
/// ones where there are none, or where the file is no TIFF or is damaged.
/// Cost: four reads.
[[nodiscard]] GeoTiffKeys keys_of_tiff(const std::string& path);

}  // namespace ptin
