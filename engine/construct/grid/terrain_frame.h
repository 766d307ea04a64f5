// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frame that every source of a terrain delivers beside its samples (grid, heights, CRS), and
// the choices by which sources are read. Rasters are in raster_source.h, points in point_buckets.h,
// TINs in tin_source.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/construct/read/point_stream.h"
#include "engine/geometry/affine.h"
#include "engine/geometry/height.h"

namespace ptin {

/// How grid positions and height codes relate to the world, and what was lost on the way to the
/// grid.
struct TerrainFrame {
  AffineMap map;
  HeightEncoding heights;
  std::string crs_wkt;  ///< WKT2:2019 of the horizontal or compound CRS; empty when unknown.
  bool vertical_crs_known = false;
  bool geographic = false;      ///< Coordinates are degrees.
  std::string horizontal_unit;  ///< "metre", "degree", "US survey foot", "unknown".
  std::string vertical_unit;
  double height_rounding = 0.0;  ///< Largest rounding of a height into its encoding, height's unit.
  /// Smallest step between heights, > 0: `step` for int32; for float32 the decimal step found, else
  /// (rounded int32 too) range / 2^16.
  double height_quantum = 0.0;
  /// Of all samples with a height; min > max when there is none.
  double min_height = 0.0, max_height = 0.0;
};

/// The height of points that fall together on one grid position.
enum class PointMerge : std::uint8_t { kMean, kLowest, kHighest };

/// Choices that decide what is read from a source.
struct SourceOptions {
  /// Overrides the source's own. Points of this height are left out.
  std::optional<double> nodata;
  std::optional<double> resolution;  ///< Points: grid unit in CRS units.
  struct Bounds {
    double min_x, min_y, max_x, max_y;
  };
  std::optional<Bounds> bbox;            ///< CRS units; samples outside are left out.
  std::string a_srs;                     ///< Overrides the CRS; anything GDAL understands.
  std::string vertical_crs;              ///< Added as the vertical part, e.g. "EPSG:5773".
  PointMerge merge = PointMerge::kMean;  ///< Points.
  PointChoice points;                    ///< Points: which of them.
};

}  // namespace ptin
