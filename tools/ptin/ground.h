// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Earth below a CRS: distances over ground, and its size, in the unit of the heights.
#pragma once

#include <functional>
#include <string>

#include "engine/geometry/affine.h"

namespace ptin::tools {

struct Ground {
  /// Between two positions in map units: along the ellipsoid in a geographic CRS, else in the
  /// plane.
  std::function<double(MapPoint, MapPoint)> distance;
  /// How long a step of one map unit along x, and along y, is over ground at a position: in a
  /// geographic CRS on the ellipsoid there.
  std::function<MapPoint(MapPoint)> per_map_unit;
  double earth_diameter = 2 * 6378137.0;  ///< Twice the semi-major axis, as GDAL takes it.
  double metres_per_height = 1.0;         ///< 1 when the CRS says nothing of heights.
  bool geographic = false;                ///< Map units are angles.
};

/// @param crs_wkt  Empty or unknown: plane metres.
[[nodiscard]] Ground ground_of(const std::string& crs_wkt);

}  // namespace ptin::tools
