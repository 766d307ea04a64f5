// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points and lines against every triangle of a TIN, in rationals: slow and obviously right. Shares
// no code with the walks.
#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/shape/spot.h"

namespace ptin::reference {

using Rational = boost::multiprecision::cpp_rational;

/// A position in grid units.
struct RationalPoint {
  Rational x, y;
};
[[nodiscard]] RationalPoint rational_of(Spot s);
[[nodiscard]] RationalPoint rational_of(GridPoint p);
[[nodiscard]] Rational rational_of(Int128 v);
/// Twice the area of a triangle, positive where its corners go round to the left.
[[nodiscard]] Rational cross(const RationalPoint& a, const RationalPoint& b,
                             const RationalPoint& c);
/// Whether both are the same number, or both are none.
[[nodiscard]] inline bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

/// Closed triangles that hold the point.
[[nodiscard]] std::vector<TriangleId> triangles_at(const Tin& tin, const RationalPoint& p);
/// Which of several triangles that hold a point answers for it: surface before void, then the
/// smallest keys.
[[nodiscard]] TriangleId answering_among(const Tin& tin, const std::vector<TriangleId>& at);

/// Height code of the plane of a triangle. REQUIRES: its corners have heights.
[[nodiscard]] Rational code_on(const Tin& tin, const HeightEncoding& heights, TriangleId t,
                               const RationalPoint& p);

/// The shares of the way from p to q that lie in a closed triangle; none when they do not meet.
struct Shares {
  Rational from, to;
};
[[nodiscard]] std::optional<Shares> shares_in(const Tin& tin, TriangleId t, const RationalPoint& p,
                                              const RationalPoint& q);

/// p + share (q - p).
[[nodiscard]] RationalPoint along(const RationalPoint& p, const RationalPoint& q,
                                  const Rational& share);

/// Every share at which a walk from p to q stops: where it meets the domain first and last, passes
/// a vertex, or crosses an edge that it does not follow.
[[nodiscard]] std::set<Rational> stops(const Tin& tin, const RationalPoint& p,
                                       const RationalPoint& q);

/// A spot that is often on a vertex, in an edge, on the border's line, or outside.
[[nodiscard]] Spot nasty_spot(std::mt19937_64& random, const Tin& tin);

}  // namespace ptin::reference
