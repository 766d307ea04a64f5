// SPDX-License-Identifier: GPL-3.0-or-later
//
// The CRS of a LAS file: its variable length records, before and behind its points, and which of them
// counts.
#pragma once

#include "engine/construct/grid/geotiff_keys.h"
#include "engine/construct/read/las_file.h"

namespace ptin {

/// The CRS that the records declare: as WKT where the header says so or there are no GeoTIFF keys, else
/// that of the keys. Where this is not understood, or says nothing of heights, the other one counts.
/// The last text that is understood counts. Text that GDAL does not understand is handed
/// on where there is nothing else, and reported when the CRS is resolved.
/// @throws Error io_error  the file cannot be read
/// Cost: some milliseconds. Memory: up to 64 MiB of records that declare a CRS.
[[nodiscard]] DeclaredCrs declared_by_las(const LasFile& file, const LasHeader& header);

}  // namespace ptin
