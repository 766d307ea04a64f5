// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons as callers give them: WKT, a file with WKT, or any vector file that GDAL reads.
#pragma once

#include <string>

#include "engine/query/terrain.h"

namespace ptin::tools {

/// The polygon in `text`: WKT when it reads "POLYGON..." or "MULTIPOLYGON...", else the name of a
/// file with WKT or of a vector file. The rings of a feature are told apart by nesting (even-odd).
/// Of a vector file's first layer, all that any of its polygons covers is inside. A file with a CRS
/// of its own is transformed into `crs_wkt` when both are known.
/// @throws Error not_found         no such file
///               invalid_argument  not a polygon; not a vector file; the CRS cannot be transformed
[[nodiscard]] Polygon read_polygon(const std::string& text, const std::string& crs_wkt);

}  // namespace ptin::tools
