// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/ground.h"

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

GroundFacts facts_on(const OGRSpatialReference& srs, double metres_per_height) {
  GroundFacts facts;
  facts.geographic = srs.IsGeographic() != 0;
  facts.semi_major = srs.GetSemiMajor();
  facts.inverse_flattening = srs.GetInvFlattening();
  facts.metres_per_height = metres_per_height;
  if (facts.geographic) {
    facts.radians_per_map_unit = srs.GetAngularUnits();
  } else {
    facts.metres_per_map_unit = srs.GetLinearUnits();
  }
  return facts;
}

GeodesicLength geodesic_of(const GroundFacts& facts) {
  geod_geodesic ellipsoid;
  const double inverse = facts.inverse_flattening;
  geod_init(&ellipsoid, facts.semi_major, inverse > 0 ? 1 / inverse : 0.0);
  return [ellipsoid](MapPoint a, MapPoint b) {
    double metres = 0.0;
    geod_inverse(&ellipsoid, a.y, a.x, b.y, b.x, &metres, nullptr, nullptr);
    return metres;
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
  if (srs.IsGeographic() != 0) return ground_of(facts_on(srs, 1.0), {}).per_map_unit(at);
  if (crs.horizontal_unit == "unknown") return std::nullopt;
  const double metres = srs.GetLinearUnits();
  return MapPoint{metres, metres};
}

GroundFacts ground_facts_of(const CrsFacts& crs) {
  OGRSpatialReference srs;
  if (!crs.wkt.empty() && srs.importFromWkt(crs.wkt.c_str()) == OGRERR_NONE) {
    return facts_on(srs, metres_per_height(srs, crs.vertical_unit));
  }
  GroundFacts facts;
  if (const auto told = metres_in(crs.horizontal_unit); told) {
    facts.metres_per_map_unit = *told;  // by the source, without a CRS
    facts.metres_per_height = metres_in(crs.vertical_unit).value_or(*told);
  }
  return facts;
}

Ground ground_of(const CrsFacts& crs) {
  const GroundFacts facts = ground_facts_of(crs);
  return ground_of(facts, geodesic_of(facts));
}

}  // namespace ptin
