// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words by which a dataset names a CRS of which GDAL makes none, or another one.
#pragma once

#include <string>

class GDALDataset;

namespace ptin {

/// The text of the .prj that belongs to a dataset; "" for none, and where it cannot be read.
[[nodiscard]] std::string prj_of(GDALDataset& data);

/// The text by which a dataset, or a file beside it, names a CRS; "" where nothing names one, or where
/// it is not known how the format does. To be asked where GDAL knows no CRS.
/// Cost: reads up to 128 KiB of formats that are texts.
[[nodiscard]] std::string crs_in_text(GDALDataset& data);

/// The CRS that a GeoJSON names, whatever GDAL makes of it; "" for none.
[[nodiscard]] std::string crs_in_geojson(GDALDataset& data);

}  // namespace ptin
