// SPDX-License-Identifier: GPL-3.0-or-later
//
// Attributes of a netCDF file that speak of CRS and units, which GDAL hands on as metadata alone.
#pragma once

#include <string>

#include <gdal_priv.h>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// "degree" where variables of coordinates are in degrees to the east and to the north; else "".
[[nodiscard]] std::string plane_unit_of_items(GDALDataset& data);

/// Warns of a geoid or a vertical datum that is named by an attribute alone. The kind begins with
/// "crs_" (see warnings_that_count()).
void warn_of_vertical_items(GDALDataset& data, const std::string& path, SourceWarnings& warnings);

}  // namespace ptin
