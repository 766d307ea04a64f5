// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/decoder/wasm/ground.h"

#include <cmath>
#include <limits>

#include <boost/geometry/formulas/vincenty_inverse.hpp>
#include <boost/geometry/srs/spheroid.hpp>

#include "tools/decoder/wasm/module.h"

namespace ptin::viewer {

namespace {

GroundFacts& told() {
  static GroundFacts the_told;
  return the_told;
}

/// Metres along the ellipsoid, by Vincenty's formula as Boost has it: within 0.1 mm of Karney's. It does not converge towards
/// the opposite side of the Earth, where the answer is not a number.
double geodesic_length(MapPoint a, MapPoint b) {
  constexpr double kRadians = 3.14159265358979323846 / 180;
  constexpr double kFarthest = 170.0;  // degrees of longitude
  const double aside = std::abs(std::remainder(b.x - a.x, 360.0));
  if (!(aside <= kFarthest && std::abs(a.y) <= 90 && std::abs(b.y) <= 90)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const GroundFacts& facts = told();
  const double f = facts.inverse_flattening > 0 ? 1 / facts.inverse_flattening : 0.0;
  const boost::geometry::srs::spheroid<double> ellipsoid(facts.semi_major,
                                                         facts.semi_major * (1 - f));
  using Inverse = boost::geometry::formula::vincenty_inverse<double, true, false>;
  return Inverse::apply(a.x * kRadians, a.y * kRadians, b.x * kRadians, b.y * kRadians, ellipsoid)
      .distance;
}

}  // namespace

Ground ground() { return ground_of(told(), geodesic_length); }

}  // namespace ptin::viewer

// NOLINTBEGIN(bugprone-reserved-identifier): the name by which the C library calls it.
/// Sine and cosine of angles beyond 2^20 quarter turns: the C library's own takes 1200 bits of 2 / pi, which no page should fetch for
/// angles on the Earth. Not a number, as of an infinite one.
extern "C" int __rem_pio2_large(double*, double* rest, int, int, int precision) {
  rest[0] = std::numeric_limits<double>::quiet_NaN();
  if (precision > 0) rest[1] = rest[0];
  return 0;
}
// NOLINTEND(bugprone-reserved-identifier)

/// The numbers of GroundFacts, in their order.
PTIN_EXPORT(describeGround)
void describe_ground(bool geographic, double semi_major, double inverse_flattening,
                     double radians_per_map_unit, double metres_per_map_unit,
                     double metres_per_height) {
  ptin::viewer::told() = {geographic,           semi_major,          inverse_flattening,
                          radians_per_map_unit, metres_per_map_unit, metres_per_height};
}
