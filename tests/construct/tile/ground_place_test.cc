// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/ground_place.h"

#include <random>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

namespace ptin {
namespace {

using boost::multiprecision::cpp_rational;

/// The square of the distance from p to the line a-b, with nothing rounded.
cpp_rational squared_distance(GroundPlace p, GroundPlace a, GroundPlace b) {
  const cpp_rational ux = cpp_rational(b.x) - cpp_rational(a.x);
  const cpp_rational uy = cpp_rational(b.y) - cpp_rational(a.y);
  const cpp_rational cross =
      ux * (cpp_rational(p.y) - cpp_rational(a.y)) - uy * (cpp_rational(p.x) - cpp_rational(a.x));
  return cross * cross / (ux * ux + uy * uy);
}

TEST(DistanceBound, HoldsForPointsBesideLongEdges) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> far(-4'000'000, 4'000'000);
  std::uniform_int_distribution<int> near(-1, 1);
  std::uniform_real_distribution<double> share(0.1, 0.9);
  for (int i = 0; i < 20'000; ++i) {
    const GroundPlace a{double(far(random)), double(far(random))};
    const GroundPlace b{double(far(random)), double(far(random))};
    const double t = share(random);
    const GroundPlace p{std::round(a.x + t * (b.x - a.x)) + near(random),
                        std::round(a.y + t * (b.y - a.y)) + near(random)};
    const cpp_rational bound(distance_bound(p, a, b, {1.0, 1.0}));
    ASSERT_GE(bound * bound, squared_distance(p, a, b)) << "case " << i;
    ASSERT_LE(bound, cpp_rational(std::sqrt(double(squared_distance(p, a, b))) + 1e-7))
        << "case " << i;
  }
}

}  // namespace
}  // namespace ptin
