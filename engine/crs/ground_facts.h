// SPDX-License-Identifier: GPL-3.0-or-later
//
// The numbers on which distances over ground depend, apart from a CRS: a receiver of streams has
// these, and no library of projections.
#pragma once

#include <functional>

#include "engine/geometry/affine.h"

namespace ptin {

struct GroundFacts {
  bool geographic = false;            ///< Map units are angles.
  double semi_major = 6378137.0;      ///< Semi-major axis of the ellipsoid, metres.
  double inverse_flattening = 0.0;    ///< 0: a sphere.
  double radians_per_map_unit = 0.0;  ///< Size of a map unit that is an angle.
  double metres_per_map_unit = 1.0;   ///< Size of a plane's map unit; 1 where nobody knows it.
  double metres_per_height = 1.0;     ///< Where nobody knows it: the plane's, or 1.
};

/// Metres along an ellipsoid between two positions, x (longitude) and y (latitude) in degrees.
using GeodesicLength = std::function<double(MapPoint, MapPoint)>;

/// The Earth below a CRS: distances over ground, and its size, in the unit of the heights.
struct Ground {
  /// The distance over ground between two positions in map units: along the ellipsoid in a
  /// geographic CRS, else in the plane.
  std::function<double(MapPoint, MapPoint)> distance;
  /// The length over ground, at a position, of one map unit along x and of one along y. In a
  /// geographic CRS these are lengths on the ellipsoid.
  std::function<MapPoint(MapPoint)> per_map_unit;
  /// Twice the semi-major axis, as GDAL takes it, in the unit of the heights.
  double earth_diameter = 2 * 6378137.0;
  double metres_per_height = 1.0;
  bool geographic = false;  ///< Map units are angles.
};

/// @param geodesic  Along the ellipsoid of the facts; asked where they are geographic.
[[nodiscard]] Ground ground_of(const GroundFacts& facts, const GeodesicLength& geodesic);

}  // namespace ptin
