// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters whose values are depths by what the file says beside its CRS.
#pragma once

#include <string>

#include <gdal_priv.h>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// Refuses a band that says that its values grow downwards: by the attribute `positive`, which is
/// "down", or by a `standard_name` of depths, as the conventions of netCDF have them. Warns of one
/// that has merely a name of depths. A band whose `positive` is "up" has heights, whatever its name.
/// @throws Error invalid_argument  as above
void refuse_depths(GDALRasterBand& band, const std::string& path, SourceWarnings& warnings);

}  // namespace ptin
