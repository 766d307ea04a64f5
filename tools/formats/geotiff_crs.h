// SPDX-License-Identifier: GPL-3.0-or-later
//
// The CRS of a GeoTIFF that is written.
#pragma once

#include <string>

class GDALDataset;

namespace ptin::tools {

/// Gives a dataset of GDAL's driver GTiff its CRS; none where GDAL does not understand the text. GDAL
/// writes no projected CRS of three axes: such a one is written as its plane and the code of heights
/// above its ellipsoid, where EPSG has one for metres; else as its plane alone.
/// @param has_heights  The values are heights; else the plane alone is written of such a CRS.
/// @param path         Path of the file that is written, for the error.
/// @throws Error  as gdal_failure() (tools/output): GDAL does not take the CRS
void set_geotiff_crs(GDALDataset& dataset, const std::string& wkt, bool has_heights,
                     const std::string& path);

}  // namespace ptin::tools
