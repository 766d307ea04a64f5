// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frame that every source of a terrain delivers beside its samples: grid, heights and CRS.
// Rasters are in raster/raster_source.h, points in points/point_buckets.h, TINs in
// tin/tin_source.h.
#pragma once

#include <string>

#include "engine/geometry/affine.h"
#include "engine/geometry/height.h"

namespace ptin {

/// How grid positions and height codes relate to the world, and what was lost on the way to the
/// grid.
struct TerrainFrame {
  AffineMap map;           ///< From the grid to the CRS.
  HeightEncoding heights;  ///< From stored heights to heights.
  std::string crs_wkt;     ///< WKT2:2019 of the horizontal or compound CRS; empty when unknown.
  bool vertical_crs_known = false;
  bool geographic = false;      ///< Coordinates are degrees.
  std::string horizontal_unit;  ///< "metre", "degree", "US survey foot", "unknown".
  std::string vertical_unit;
  double height_rounding = 0.0;  ///< Largest rounding of a height into its encoding, height's unit.
  /// The smallest step between heights, > 0, height's unit. For int32 it is the encoding's step,
  /// for float32 the decimal step that holds all heights. Where no decimal step does, and int32
  /// heights are rounded therefore, it is range / 2^16, or the encoding's step if that is larger.
  double height_quantum = 0.0;
  /// Range of all decoded heights of samples; min > max when no sample has one.
  double min_height = 0.0, max_height = 0.0;
};

}  // namespace ptin
