// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/slope.h"

#include <algorithm>
#include <cmath>

namespace ptin::tools {

namespace {

constexpr double kDegree = M_PI / 180;

double rise_of(const Slope& slope) noexcept { return std::hypot(slope.east, slope.north); }

}  // namespace

Slope slope_of(const GridNormal& normal, const StoreFacts& facts, MapPoint per_map_unit) noexcept {
  const double east = facts.map.step_x * per_map_unit.x;
  const double north = facts.map.step_y * per_map_unit.y;
  const auto rise = [&](double part, double run) {
    return run > 0 ? -part / normal.z * facts.heights.step / run : 0.0;
  };
  return {rise(normal.x, east), rise(normal.y, north)};
}

double degrees_of(const Slope& slope) noexcept { return std::atan(rise_of(slope)) / kDegree; }

double percent_of(const Slope& slope) noexcept { return 100 * rise_of(slope); }

std::optional<double> aspect_of(const Slope& slope) noexcept {
  if (slope.east == 0 && slope.north == 0) return std::nullopt;
  const double aspect = std::atan2(-slope.east, -slope.north) / kDegree;
  const double turned = aspect < 0 ? aspect + 360 : aspect;
  return turned < 360 ? turned : 0.0;  // a little west of north rounds to the whole circle
}

Light::Light(double azimuth, double altitude) noexcept
    : east_(std::sin(azimuth * kDegree) * std::cos(altitude * kDegree)),
      north_(std::cos(azimuth * kDegree) * std::cos(altitude * kDegree)),
      up_(std::sin(altitude * kDegree)) {}

double Light::on(const Slope& slope) const noexcept {
  const double along = up_ - east_ * slope.east - north_ * slope.north;
  return along / std::sqrt(1 + slope.east * slope.east + slope.north * slope.north);
}

double grey_of(double cosine) noexcept { return std::round(1 + 254 * std::max(0.0, cosine)); }

}  // namespace ptin::tools
