// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines in the headers of some formats that speak of places and heights, and that GDAL passes over.
#pragma once

#include <string>

#include <gdal_priv.h>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// Looks at the header of a raster itself: of ERS for a rotation, of SAGA for bytes before its heights,
/// of an Arc/Info ASCII grid for a corner in x beside a centre in y; of a GeoPackage for values that are
/// those of corners. Cost: reads up to 64 KiB of such a file.
/// @param warnings  Receives what there is to be warned of.
/// @throws Error invalid_argument  GDAL would place the samples, or read the heights, otherwise than
///                                 the header says
void check_header(GDALDataset& data, const std::string& path, SourceWarnings& warnings);

}  // namespace ptin
