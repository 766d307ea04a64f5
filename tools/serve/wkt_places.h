// SPDX-License-Identifier: GPL-3.0-or-later
//
// Positions and shapes as OGC's questions give them: `coords` in WKT.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/query/questions.h"

namespace ptin::serve {

// All throw http::Problem 400, which names the parameter: no WKT, or another shape.

/// The positions of a POINT or a MULTIPOINT.
[[nodiscard]] std::vector<MapPoint> points_of_wkt(const std::string& wkt,
                                                  std::string_view parameter);
/// The lines of a LINESTRING or a MULTILINESTRING.
[[nodiscard]] std::vector<std::vector<MapPoint>> lines_of_wkt(const std::string& wkt,
                                                              std::string_view parameter);
/// The rings of a POLYGON or a MULTIPOLYGON.
[[nodiscard]] Polygon polygon_of_wkt(const std::string& wkt, std::string_view parameter);

}  // namespace ptin::serve
