// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/ground.h"

#include <cmath>
#include <optional>

#include <geodesic.h>
#include <ogr_spatialref.h>

#include "engine/crs/height_unit.h"

namespace ptin {

namespace {

/// Metres in the unit of the heights: that of the vertical CRS, else `unit`, which is that of the
/// source's band. Where neither is known: the unit of the plane, as GDAL's tools take it.
double metres_per_height(const OGRSpatialReference& srs, const std::string& unit) {
  if (srs.IsCompound() != 0) return srs.GetTargetLinearUnits("VERT_CS", nullptr);
  if (const std::optional<double> metres = metres_in(unit)) return *metres;
  return srs.IsGeographic() != 0 ? 1.0 : srs.GetLinearUnits();
}

/// Lengths of one map unit on the ellipsoid, from its radii of curvature: across the meridian for
/// x, along the meridian for y.
std::function<MapPoint(MapPoint)> on_ellipsoid(const OGRSpatialReference& srs, double height_unit) {
  const double a = srs.GetSemiMajor() / height_unit;
  const double inverse = srs.GetInvFlattening();
  const double f = inverse > 0 ? 1 / inverse : 0.0;
  return [a, e2 = f * (2 - f), unit = srs.GetAngularUnits()](MapPoint p) {
    const double sine = std::sin(p.y * unit);
    const double w2 = 1 - e2 * sine * sine;
    const double normal = a / std::sqrt(w2);
    return MapPoint{unit * normal * std::sqrt(1 - sine * sine), unit * normal * (1 - e2) / w2};
  };
}

}  // namespace

std::string unit_of_ground(const CrsFacts& crs) {
  const bool is_known = !crs.vertical_name.empty() || metres_in(crs.vertical_unit).has_value();
  if (is_known) return crs.vertical_unit;
  return crs.geographic ? "metre" : crs.horizontal_unit;
}

std::optional<MapPoint> metres_per_map_unit(const CrsFacts& crs, MapPoint at) {
  OGRSpatialReference srs;
  if (crs.wkt.empty() || srs.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE) {
    const std::optional<double> metres = metres_in(height_unit_named(crs.horizontal_unit));
    return metres ? std::optional<MapPoint>({*metres, *metres}) : std::nullopt;
  }
  if (srs.IsGeographic() != 0) return on_ellipsoid(srs, 1.0)(at);
  if (crs.horizontal_unit == "unknown") return std::nullopt;
  const double metres = srs.GetLinearUnits();
  return MapPoint{metres, metres};
}

Ground ground_of(const CrsFacts& crs) {
  Ground ground;
  OGRSpatialReference srs;
  const bool known = !crs.wkt.empty() && srs.importFromWkt(crs.wkt.c_str()) == OGRERR_NONE;
  if (known) {
    ground.metres_per_height = metres_per_height(srs, crs.vertical_unit);
    ground.earth_diameter = 2 * srs.GetSemiMajor() / ground.metres_per_height;
  }
  if (known && srs.IsGeographic() != 0) {
    geod_geodesic ellipsoid;
    const double inverse = srs.GetInvFlattening();
    geod_init(&ellipsoid, srs.GetSemiMajor(), inverse > 0 ? 1 / inverse : 0.0);
    const double degrees = srs.GetAngularUnits() * 180 / M_PI;
    ground.distance = [ellipsoid, degrees, scale = ground.metres_per_height](MapPoint a,
                                                                             MapPoint b) {
      double metres = 0.0;
      geod_inverse(&ellipsoid, a.y * degrees, a.x * degrees, b.y * degrees, b.x * degrees, &metres,
                   nullptr, nullptr);
      return metres / scale;
    };
    ground.per_map_unit = on_ellipsoid(srs, ground.metres_per_height);
    ground.geographic = true;
    return ground;
  }
  double metres_per_map_unit = known ? srs.GetLinearUnits() : 1.0;
  if (const auto told = metres_in(crs.horizontal_unit); !known && told) {
    metres_per_map_unit = *told;  // by the source, without a CRS
    ground.metres_per_height = metres_in(crs.vertical_unit).value_or(*told);
    ground.earth_diameter /= ground.metres_per_height;
  }
  const double scale = metres_per_map_unit / ground.metres_per_height;
  ground.distance = [scale](MapPoint a, MapPoint b) {
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    return scale * std::sqrt(dx * dx + dy * dy);
  };
  ground.per_map_unit = [scale](MapPoint) { return MapPoint{scale, scale}; };
  return ground;
}

}  // namespace ptin
