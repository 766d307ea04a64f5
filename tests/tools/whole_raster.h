// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raster with all that makes it what it is.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <ogr_spatialref.h>

namespace ptin::tools::testing {

/// What of a raster comes back from its terrain.
struct Whole {
  int width = 0, height = 0, has_nodata = 0;
  std::string type, pixel_type, pixels;
  bool is_placed = false;
  std::array<double, 6> place{};
  double nodata = 0.0, scale = 1.0, offset = 0.0;
  std::vector<char> samples;  ///< In their type.
  OGRSpatialReference crs;
};

/// @throws std::runtime_error  GDAL does not open it
[[nodiscard]] Whole read_whole(const std::string& path);
/// Samples bit for bit, place, type, nodata value, CRS.
void expect_same_raster(const std::string& made, const std::string& source);

}  // namespace ptin::tools::testing
