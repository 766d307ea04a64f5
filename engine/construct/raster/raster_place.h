// SPDX-License-Identifier: GPL-3.0-or-later
//
// The place of a raster: its geotransform and CRS, and what stands in the place of one.
#pragma once

#include <string>

#include <gdal_priv.h>

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/raster/raster_part.h"

namespace ptin {

/// Sets size, map, orientation and CRS of `shape`.
/// @param warnings  Receives what there is to be warned of.
/// @throws Error invalid_argument  beyond the grid's size; rotated; placed by control points, rational
///                                 polynomials or a geolocation array alone; a CRS without a
///                                 geotransform; x is a northing
void describe_place(GDALDataset& data, const std::string& path, RasterShape& shape,
                    SourceWarnings& warnings);

}  // namespace ptin
