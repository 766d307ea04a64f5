// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's questions of the mesh that was received (engine/query/received), for WebAssembly. Answers are arrays of
// doubles, valid until the next question; src/decoder.ts knows their order.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <boost/geometry/formulas/vincenty_inverse.hpp>
#include <boost/geometry/srs/spheroid.hpp>

#include "engine/crs/ground_facts.h"
#include "engine/error.h"
#include "tools/viewer/decoder/decoder.h"

namespace {

using ptin::MapPoint;
using ptin::viewer::reader;

constexpr std::uint64_t kAnswerBytes = std::uint64_t{256} << 20;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kSpeedOfLight = 299792458.0;  // metres a second

/// What the metadata of the stream tell beside its facts.
struct Told {
  ptin::GroundFacts ground;
  bool free_of_voids = false;
  bool is_whole = false;  ///< No record of the file is missing.
};
Told& told() {
  static Told the_told;
  return the_told;
}

/// Metres along the ellipsoid, by Vincenty's formula as Boost has it: within 0.1 mm of Karney's. It does not converge towards
/// the opposite side of the Earth, where the answer is not a number.
double geodesic_length(MapPoint a, MapPoint b) {
  constexpr double kRadians = 3.14159265358979323846 / 180;
  constexpr double kFarthest = 170.0;  // degrees of longitude
  const double aside = std::abs(std::remainder(b.x - a.x, 360.0));
  if (!(aside <= kFarthest && std::abs(a.y) <= 90 && std::abs(b.y) <= 90)) return kUnknown;
  const ptin::GroundFacts& facts = told().ground;
  const double f = facts.inverse_flattening > 0 ? 1 / facts.inverse_flattening : 0.0;
  const boost::geometry::srs::spheroid<double> ellipsoid(facts.semi_major,
                                                         facts.semi_major * (1 - f));
  using Inverse = boost::geometry::formula::vincenty_inverse<double, true, false>;
  return Inverse::apply(a.x * kRadians, a.y * kRadians, b.x * kRadians, b.y * kRadians, ellipsoid)
      .distance;
}

ptin::Ground ground() { return ptin::ground_of(told().ground, geodesic_length); }

double metres_over_ground(MapPoint a, MapPoint b) {
  const ptin::Ground on = ground();
  return on.distance(a, b) * on.metres_per_height;
}

/// The distance along a profile, as the program has it: in map units, of degrees in metres.
double length_along(MapPoint a, MapPoint b) {
  if (told().ground.geographic) return metres_over_ground(a, b);
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);
}

ptin::StoreFacts& facts() {
  static ptin::StoreFacts the_facts;
  the_facts = reader().facts();
  the_facts.free_of_voids = told().free_of_voids;
  return the_facts;
}

/// @param is_certified  The certificate of the stream holds at the places that are asked.
ptin::ReceivedMesh mesh(bool is_certified) {
  const ptin::StoreFacts& of = facts();
  ptin::Certificate certificate = ptin::certificate_by_relief(of);
  if (is_certified) {
    const ptin::Certificate& now = reader().certificate();
    certificate = {std::min(now.error, certificate.error),
                   std::min(now.deviation, certificate.deviation), told().is_whole};
  }
  return {reader().tin(), of, certificate};
}

std::vector<double>& answer() {
  static std::vector<double> numbers;
  return numbers;
}

void add(const std::optional<ptin::SightPoint>& point) {
  const ptin::SightPoint none{{kUnknown, kUnknown}, kUnknown, kUnknown, kUnknown};
  const ptin::SightPoint& p = point ? *point : none;
  for (const double number : {p.position.x, p.position.y, p.distance, p.height})
    answer().push_back(number);
}

}  // namespace

/// What the metadata tell: the numbers of GroundFacts, whether the terrain is free of voids, and whether no record is missing.
PTIN_EXPORT(describe)
void describe(bool geographic, double semi_major, double inverse_flattening,
              double radians_per_map_unit, double metres_per_map_unit, double metres_per_height,
              bool free_of_voids, bool is_whole) {
  told() = {{geographic, semi_major, inverse_flattening, radians_per_map_unit, metres_per_map_unit,
             metres_per_height},
            free_of_voids,
            is_whole};
}

/// Metres over ground between two map positions; not a number where that is not known.
PTIN_EXPORT(metresBetween) double metres_between(double ax, double ay, double bx, double by) {
  return metres_over_ground({ax, ay}, {bx, by});
}

/// Metres over ground of one map unit along x and of one along y, at a position.
PTIN_EXPORT(metresPerMapUnit) const double* metres_per_map_unit(double x, double y) {
  const ptin::Ground on = ground();
  const MapPoint per_unit = on.per_map_unit({x, y});
  answer() = {per_unit.x * on.metres_per_height, per_unit.y * on.metres_per_height};
  return answer().data();
}

/// State (0 surface, 1 void, 2 outside), height, the interval of the full terrain's, and three corners: x, y on the map, height.
PTIN_EXPORT(locate) const double* locate(double x, double y, bool is_certified) {
  const ptin::ReceivedMesh of = mesh(is_certified);
  const ptin::LocatedPoint p = ptin::locate_on(of, {x, y});
  answer() = {static_cast<double>(p.state), p.height, p.height_min, p.height_max};
  for (const ptin::LocatedPoint::Corner& corner : p.triangle) {
    const MapPoint at = of.facts.map.to_map(corner.position.x, corner.position.y);
    answer().insert(answer().end(), {at.x, at.y, corner.height});
  }
  return answer().data();
}

/// What holds of any mesh of the terrain.
PTIN_EXPORT(reliefError) double relief_error() {
  return ptin::certificate_by_relief(facts()).error;
}
PTIN_EXPORT(reliefDeviation) double relief_deviation() {
  return ptin::certificate_by_relief(facts()).deviation;
}

/// The number of points, and of each: distance, x, y, height, state. The host asks for no line without a length.
PTIN_EXPORT(profile)
const double* profile(double ax, double ay, double bx, double by, bool is_certified) {
  const ptin::ReceivedMesh of = mesh(is_certified);
  if (!std::isfinite(length_along({ax, ay}, {bx, by}))) {
    ptin::refuse("the length of a line around the Earth is not known here; take a shorter one");
  }
  const std::vector<ptin::ProfilePoint> points =
      ptin::profile_on(of, {ax, ay}, {bx, by}, length_along, kAnswerBytes);
  answer() = {static_cast<double>(points.size())};
  for (const ptin::ProfilePoint& p : points) {
    answer().insert(answer().end(), {p.distance, p.position.x, p.position.y, p.height,
                                     static_cast<double>(p.state)});
  }
  return answer().data();
}

/// Verdict (as SightVerdict), length, clearance from and to, Fresnel ratio, and of clearance, obstruction and Fresnel zone: x, y,
/// distance, height. In the unit of heights; not a number: there is none. The host asks for two different ends.
PTIN_EXPORT(sight)
const double* sight(double ax, double ay, double height_a, double bx, double by, double height_b,
                    double hertz, bool is_certified) {
  const ptin::Ground on = ground();
  ptin::SightRequest request;
  request.curvature.earth_diameter = on.earth_diameter;
  request.ground_distance = on.distance;
  if (hertz > 0) request.wavelength = kSpeedOfLight / hertz / on.metres_per_height;
  const ptin::SightResult r =
      ptin::sight_on(mesh(is_certified), {{ax, ay}, height_a, {bx, by}, height_b}, request);
  answer() = {static_cast<double>(r.verdict), r.length, r.clearance_min, r.clearance_max,
              r.fresnel_ratio.value_or(kUnknown)};
  add(r.clearance_at);
  add(r.obstruction);
  add(r.fresnel_at);
  return answer().data();
}
