// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/ground_facts.h"

#include <cmath>

namespace ptin {

namespace {

/// Lengths of one map unit on the ellipsoid, from its radii of curvature: across the meridian for
/// x, along the meridian for y.
std::function<MapPoint(MapPoint)> on_ellipsoid(const GroundFacts& facts) {
  const double a = facts.semi_major / facts.metres_per_height;
  const double inverse = facts.inverse_flattening;
  const double f = inverse > 0 ? 1 / inverse : 0.0;
  return [a, e2 = f * (2 - f), unit = facts.radians_per_map_unit](MapPoint p) {
    const double sine = std::sin(p.y * unit);
    const double w2 = 1 - e2 * sine * sine;
    const double normal = a / std::sqrt(w2);
    return MapPoint{unit * normal * std::sqrt(1 - sine * sine), unit * normal * (1 - e2) / w2};
  };
}

}  // namespace

Ground ground_of(const GroundFacts& facts, const GeodesicLength& geodesic) {
  Ground ground;
  ground.metres_per_height = facts.metres_per_height;
  ground.earth_diameter = 2 * facts.semi_major / facts.metres_per_height;
  ground.geographic = facts.geographic;
  if (facts.geographic) {
    constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;
    ground.distance = [geodesic, degrees = facts.radians_per_map_unit * kDegreesPerRadian,
                       scale = facts.metres_per_height](MapPoint a, MapPoint b) {
      return geodesic({a.x * degrees, a.y * degrees}, {b.x * degrees, b.y * degrees}) / scale;
    };
    ground.per_map_unit = on_ellipsoid(facts);
    return ground;
  }
  const double scale = facts.metres_per_map_unit / facts.metres_per_height;
  ground.distance = [scale](MapPoint a, MapPoint b) {
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    return scale * std::sqrt(dx * dx + dy * dy);
  };
  ground.per_map_unit = [scale](MapPoint) { return MapPoint{scale, scale}; };
  return ground;
}

}  // namespace ptin
