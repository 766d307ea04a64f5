// SPDX-License-Identifier: GPL-3.0-or-later
//
// Positions, lines and polygons of another CRS than the terrain's, and polygons of files.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <ogr_spatialref.h>

#include "tools/python/binding.h"
#include "tools/region/straight_sides.h"

namespace ptin::python {

/// A CRS from which positions are taken to a terrain's. Its x is to the east, as the terrain's. Silent:
/// GDAL prints nothing.
class OtherCrs {
 public:
  /// @throws Error invalid_argument  GDAL does not know the CRS, or no way from it; the terrain's CRS
  ///                                 is unknown
  OtherCrs(const std::string& crs, const OpenTerrain& t);

  /// Positions in the terrain's CRS, and in the turn of the circle that it lies in; NaN where one has
  /// no place there.
  void take(std::span<MapPoint> points) const;
  /// A line or a ring, with as many corners more as its bent sides take.
  /// @throws Error as tools::transformed_sides
  [[nodiscard]] std::vector<MapPoint> path(std::span<const MapPoint> corners) const;

 private:
  std::unique_ptr<OGRCoordinateTransformation> way_;  ///< None: it is the terrain's own CRS.
  tools::SideTarget sides_;
};

}  // namespace ptin::python
