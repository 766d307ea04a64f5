// SPDX-License-Identifier: GPL-3.0-or-later
//
// The square world of web maps (EPSG:3857), and how it is divided into tiles and pixels: XYZ numbers, x
// to the east, y from the north.
#pragma once

#include <cmath>
#include <cstdint>

#include "engine/geometry/affine.h"

namespace ptin::tools {

/// A tile of level 0 is the world, of so many pixels along a side; each level has twice as many.
inline constexpr int kPixelsLog2 = 8;
/// The world ends at this latitude in the north and in the south, degrees: there it is a square.
inline constexpr double kMostMercatorLatitude = 85.05112877980659;
/// Metres along the equator.
inline constexpr double kMercatorGirth = 40075016.685578488;

/// A tile by XYZ numbers.
struct WebTile {
  int z = 0;
  std::int64_t x = 0, y = 0;
  friend bool operator==(const WebTile&, const WebTile&) = default;
};

/// Shares of the world's sides, from its north-western corner; x goes on beyond 0 and 1 as longitudes
/// do beyond 180 degrees.
[[nodiscard]] inline MapPoint world_of(double lon, double lat) noexcept {
  return {(lon + 180.0) / 360.0, 0.5 - std::asinh(std::tan(lat * (M_PI / 180.0))) / (2.0 * M_PI)};
}
[[nodiscard]] inline double longitude_of(double world_x) noexcept {
  return world_x * 360.0 - 180.0;
}
[[nodiscard]] inline double latitude_of(double world_y) noexcept {
  return std::atan(std::sinh(M_PI * (1.0 - 2.0 * world_y))) * (180.0 / M_PI);
}
/// Metres along the equator of a pixel of a level.
[[nodiscard]] inline double equator_pixel(int level) noexcept {
  return std::ldexp(kMercatorGirth, -level - kPixelsLog2);
}

}  // namespace ptin::tools
