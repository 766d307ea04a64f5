// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons as callers give them: WKT, a file with WKT, or any vector file that GDAL reads.
#pragma once

#include <optional>
#include <string>

#include "engine/query/questions.h"
#include "tools/region/vector_input.h"

namespace ptin::tools {

/// A polygon, and what was done to it.
struct AskedPolygon {
  Polygon polygon;
  std::optional<Transformed> transformed;
};
/// The polygon in `text`: WKT when it reads "POLYGON..." or "MULTIPOLYGON...", else the name of a
/// file with WKT or of a vector file. The rings of a feature are told apart by nesting (even-odd).
/// What any polygon of a vector file's first layer covers is inside. A file with a CRS of its own
/// is transformed into the terrain's when both are known.
/// @throws Error not_found         no such file
///               invalid_argument  not a polygon; not a vector file; the CRS cannot be transformed
///               as read_geometries()
[[nodiscard]] AskedPolygon read_polygon(const std::string& text, const TerrainPlane& plane);

}  // namespace ptin::tools
