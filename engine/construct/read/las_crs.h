// SPDX-License-Identifier: GPL-3.0-or-later
//
// The CRS of a LAS file: which of its records counts.
#pragma once

#include "engine/construct/grid/geotiff_keys.h"
#include "engine/construct/read/las_records.h"

namespace ptin {

/// The CRS that the records declare: as WKT where the header says so or there are no GeoTIFF keys, else
/// that of the keys. Where this is not understood, or says nothing of heights, the other one counts.
/// The last text that is understood counts. Text that GDAL does not understand is handed
/// on where there is nothing else, and reported when the CRS is resolved.
/// @param is_wkt  The header says that the CRS is WKT.
/// Cost: some milliseconds.
[[nodiscard]] DeclaredCrs crs_of_records(const LasRecords& records, bool is_wkt);

}  // namespace ptin
