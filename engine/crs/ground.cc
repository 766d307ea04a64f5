// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/ground.h"

#include <memory>
#include <mutex>
#include <optional>

#include <geodesic.h>

#include "engine/crs/height_unit.h"

namespace ptin {

namespace {

/// PROJ is not asked before a distance is.
class Ellipsoid {
 public:
  explicit Ellipsoid(const GroundFacts& facts) : facts_(facts) {}

  [[nodiscard]] double distance(MapPoint a, MapPoint b) {
    std::call_once(made_, [this] {
      const double inverse = facts_.inverse_flattening;
      geod_init(&geodesic_, facts_.semi_major, inverse > 0 ? 1 / inverse : 0.0);
    });
    double metres = 0.0;
    geod_inverse(&geodesic_, a.y, a.x, b.y, b.x, &metres, nullptr, nullptr);
    return metres;
  }

 private:
  GroundFacts facts_;
  std::once_flag made_;
  geod_geodesic geodesic_{};
};

GeodesicLength geodesic_of(const GroundFacts& facts) {
  return [ellipsoid = std::make_shared<Ellipsoid>(facts)](MapPoint a, MapPoint b) {
    return ellipsoid->distance(a, b);
  };
}

}  // namespace

std::string unit_of_ground(const CrsFacts& crs) {
  const bool is_known = !crs.vertical_name.empty() || metres_in(crs.vertical_unit).has_value();
  if (is_known) return crs.vertical_unit;
  return crs.geographic ? "metre" : crs.horizontal_unit;
}

std::optional<MapPoint> metres_per_map_unit(const CrsFacts& crs, MapPoint at) {
  if (!crs.is_understood) {
    const std::optional<double> metres = metres_in(height_unit_named(crs.horizontal_unit));
    return metres ? std::optional<MapPoint>({*metres, *metres}) : std::nullopt;
  }
  if (crs.geographic) {
    GroundFacts in_metres = crs.ground;
    in_metres.metres_per_height = 1.0;
    return ground_of(in_metres, {}).per_map_unit(at);
  }
  if (crs.horizontal_unit == "unknown") return std::nullopt;
  return MapPoint{crs.ground.metres_per_map_unit, crs.ground.metres_per_map_unit};
}

GroundFacts ground_facts_of(const CrsFacts& crs) {
  GroundFacts facts = crs.ground;
  if (crs.is_understood) {
    if (facts.metres_per_height > 0) return facts;
    // Heights have the unit of the source's band; where nobody knows it that of the plane, as GDAL's
    // tools take it.
    facts.metres_per_height =
        metres_in(crs.vertical_unit).value_or(crs.geographic ? 1.0 : facts.metres_per_map_unit);
    return facts;
  }
  facts = {};
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
