// SPDX-License-Identifier: GPL-3.0-or-later
//
// How steep a surface is, which way it falls, and how lit it is: by gdaldem's conventions, for
// rasters, fields and pictures alike.
#pragma once

#include <optional>

#include "engine/query/questions.h"

namespace ptin::tools {

/// The rise of a surface over ground, height and ground in one unit.
struct Slope {
  double east = 0.0;
  double north = 0.0;
};

/// The slope of a surface with this normal.
/// @param per_map_unit  Ground::per_map_unit at the place. At a pole, where east is no direction,
///                      nothing rises to the east.
/// REQUIRES: normal.z > 0.
[[nodiscard]] Slope slope_of(const GridNormal& normal, const StoreFacts& facts,
                             MapPoint per_map_unit) noexcept;

/// The angle to the horizontal, in degrees from 0 to 90.
[[nodiscard]] double degrees_of(const Slope& slope) noexcept;
/// Hundred times the rise over the run: 100 is 45 degrees.
[[nodiscard]] double percent_of(const Slope& slope) noexcept;
/// Where the surface falls to, in degrees clockwise from north, at least 0 and below 360; none
/// where it is flat.
[[nodiscard]] std::optional<double> aspect_of(const Slope& slope) noexcept;

/// The sun.
class Light {
 public:
  /// @param azimuth   Where the light comes from, in degrees clockwise from north.
  /// @param altitude  How high it stands, in degrees.
  Light(double azimuth, double altitude) noexcept;
  /// The cosine of the angle between the surface's normal and the light; negative on what is turned
  /// away. Nothing casts a shadow.
  [[nodiscard]] double on(const Slope& slope) const noexcept;

 private:
  double east_, north_, up_;
};

/// A cosine of Light::on() as a grey value from 1 (dark) to 255; 0 is left to what has no surface.
[[nodiscard]] double grey_of(double cosine) noexcept;

}  // namespace ptin::tools
