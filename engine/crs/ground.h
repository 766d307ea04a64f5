// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Earth below a CRS: distances over ground, and its size, in the unit of the heights.
#pragma once

#include <functional>
#include <string>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/affine.h"

namespace ptin {

struct Ground {
  /// Between two positions in map units: along the ellipsoid in a geographic CRS, else in the
  /// plane.
  std::function<double(MapPoint, MapPoint)> distance;
  /// How long a step of one map unit along x, and along y, is over ground at a position: in a
  /// geographic CRS on the ellipsoid there.
  std::function<MapPoint(MapPoint)> per_map_unit;
  double earth_diameter = 2 * 6378137.0;  ///< Twice the semi-major axis, as GDAL takes it.
  double metres_per_height = 1.0;
  bool geographic = false;  ///< Map units are angles.
};

/// The unit of lengths over ground, by name: that of heights, or what is taken for it.
[[nodiscard]] std::string unit_of_ground(const CrsFacts& crs);

/// @param crs  One without WKT, or whose WKT is not understood: plane metres, heights in metres.
///             Heights of no known unit are in that of the plane, over degrees in metres.
[[nodiscard]] Ground ground_of(const CrsFacts& crs);

}  // namespace ptin
