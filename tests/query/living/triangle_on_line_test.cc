// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a line and a triangle share, against rationals.
#include "engine/query/living/triangle_on_line.h"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/query/line_oracle.h"
#include "tests/query/sight/sight_oracle.h"

namespace ptin {
namespace {

using reference::Rational;
using reference::rational_of;
using reference::RationalPoint;
using reference::SmallTerrain;

Rational share_of(const LinePoint& p) {
  return rational_of(p.numerator) / rational_of(p.denominator);
}

Rational code_of(const WeightedCodes& codes) {
  Rational sum = 0;
  Rational whole = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(codes.count); ++i) {
    sum += rational_of(codes.weight[i]) * Rational(codes.code[i]);
    whole += rational_of(codes.weight[i]);
  }
  return sum / whole;
}

RC_GTEST_PROP(SharedStretch, IsThatOfRationals, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain terrain(seed);
  const Tin& tin = terrain.full;
  const HeightEncoding& heights = terrain.terrain->store().facts().heights;
  const Spot p = reference::nasty_spot(random, tin);
  const Spot q = reference::nasty_spot(random, tin);
  RC_PRE(!(p == q));
  const RationalPoint a = rational_of(p);
  const RationalPoint b = rational_of(q);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const LivingTriangle living = living_triangle(tin, t);
    const std::optional<reference::Shares> known = reference::shares_in(tin, t, a, b);
    const std::optional<SharedStretch> found = shared_stretch(living, heights, p, q);
    RC_ASSERT(found.has_value() == known.has_value());
    if (!found) continue;
    RC_ASSERT(found->is_point == (known->from == known->to));
    const int on_line = (side(p, q, living.corner[0].position) == 0 ? 1 : 0) +
                        (side(p, q, living.corner[1].position) == 0 ? 1 : 0) +
                        (side(p, q, living.corner[2].position) == 0 ? 1 : 0);
    RC_ASSERT(found->is_point || found->along_edge == (on_line == 2));
    for (const bool is_from : {true, false}) {
      const LinePoint& point = is_from ? found->from : found->to;
      RC_ASSERT(share_of(point) == (is_from ? known->from : known->to));
      RC_ASSERT(point.is_inner() == (share_of(point) > 0 && share_of(point) < 1));
      if (!living.is_void) {
        const RationalPoint at = reference::along(a, b, share_of(point));
        RC_ASSERT(code_of(point.ground) == reference::code_on(tin, heights, t, at));
      }
    }
  }
}

}  // namespace
}  // namespace ptin
