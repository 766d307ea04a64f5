// SPDX-License-Identifier: GPL-3.0-or-later
//
// Walks against every triangle, in rationals.
#include "engine/query/walk/walk.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::along;
using reference::nasty_spot;
using reference::Rational;
using reference::rational_of;
using reference::RationalPoint;

Tin random_tin(std::mt19937_64& random) {
  const auto size = [&] { return 2 + static_cast<int>(random() % 8); };
  switch (random() % 3) {
    case 0:
      return reference::random_grid(random, size(), size(), 1 + static_cast<int>(random() % 3),
                                    0.0);
    case 1:
      return reference::random_grid(random, size(), size(), 1, 0.3);
    default:
      return reference::random_points(random, 5 + static_cast<int>(random() % 60), 40);
  }
}

TriangleId any_triangle(std::mt19937_64& random, const Tin& tin) {
  return static_cast<TriangleId>(random() % tin.triangles.size());
}

RC_GTEST_PROP(FindSpot, AgreesWithAllTriangles, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Tin tin = random_tin(random);
  const HeightEncoding heights{HeightType::int32, 1.0, 0.0};
  for (int i = 0; i < 20; ++i) {
    const Spot q = nasty_spot(random, tin);
    const std::vector<TriangleId> at = reference::triangles_at(tin, rational_of(q));
    const Place place = find_spot(tin, q, any_triangle(random, tin));
    RC_ASSERT((place.lies == Lies::kOutside) == at.empty());
    if (at.empty()) {
      continue;
    }
    RC_ASSERT(std::count(at.begin(), at.end(), place.triangle) == 1);
    RC_ASSERT(answering_triangle(tin, place) == reference::answering_among(tin, at));
    const Footing f = footing_of(tin, q, place);
    RC_ASSERT(f.lies() == place.lies);
    if (tin.classes[answering_triangle(tin, place)] == TriangleClass::kSurface) {
      const Rational exact =
          reference::code_on(tin, heights, answering_triangle(tin, place), rational_of(q));
      const double code = code_at(tin, heights, f);
      RC_ASSERT(abs(Rational(code) - exact) <= Rational(60.0 * 8 / 9007199254740992.0));
      if (place.lies == Lies::kOnVertex) {
        RC_ASSERT(Rational(code) == exact);
      }
    }
  }
}

struct Walked {
  std::vector<Rational> stops;
  std::vector<LinePiece> pieces;
  bool meets, begins_inside, ends_inside;
};

Walked walked(const Tin& tin, Spot p, Spot q, TriangleId start) {
  LineWalk walk(tin, p, q, start);
  Walked result{{}, {}, walk.meets_domain(), walk.begins_inside(), false};
  if (result.meets) {
    result.stops.push_back(rational_of(walk.entry().numerator) /
                           rational_of(walk.entry().denominator));
  }
  while (walk.next() && result.pieces.size() < 10000) {
    result.pieces.push_back(walk.piece());
    const Crossing& to = walk.piece().to;
    result.stops.push_back(rational_of(to.numerator) / rational_of(to.denominator));
  }
  result.ends_inside = walk.ends_inside();
  return result;
}

/// The position that a footing stands for.
RationalPoint position_of(const Tin& tin, const Footing& f) {
  RationalPoint sum{0, 0};
  Rational whole = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(f.count); ++i) {
    const Rational w = rational_of(f.weight[i]);
    sum.x += w * tin.position(f.vertex[i]).x;
    sum.y += w * tin.position(f.vertex[i]).y;
    whole += w;
  }
  return {sum.x / whole, sum.y / whole};
}

/// A piece lies in its triangle (along an edge: in both), and its ends are where they say they are.
void check_piece(const Tin& tin, const LinePiece& piece, const RationalPoint& p,
                 const RationalPoint& q) {
  const Rational from = rational_of(piece.from.numerator) / rational_of(piece.from.denominator);
  const Rational to = rational_of(piece.to.numerator) / rational_of(piece.to.denominator);
  RC_ASSERT(from < to);
  for (const TriangleId t : {piece.triangle, piece.other}) {
    if (t != kNone) {
      const auto shares = reference::shares_in(tin, t, p, q);
      RC_ASSERT(shares.has_value());
      RC_ASSERT(shares->from <= from);
      RC_ASSERT(to <= shares->to);
    }
  }
  for (const Crossing& c : {piece.from, piece.to}) {
    const RationalPoint wanted = along(p, q, rational_of(c.numerator) / rational_of(c.denominator));
    const RationalPoint found = position_of(tin, c.footing);
    RC_ASSERT(wanted.x == found.x);
    RC_ASSERT(wanted.y == found.y);
    for (std::size_t i = 0; i < static_cast<std::size_t>(c.footing.count); ++i) {
      RC_ASSERT(c.footing.weight[i] > 0);
    }
  }
}

RC_GTEST_PROP(LineWalk, StopsAtEveryCrossingInOrderAndNowhereElse, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Tin tin = random_tin(random);
  for (int i = 0; i < 20; ++i) {
    const Spot p = nasty_spot(random, tin);
    const Spot q = nasty_spot(random, tin);
    if (p == q) {
      continue;
    }
    const RationalPoint from = rational_of(p);
    const RationalPoint to = rational_of(q);
    const std::set<Rational> wanted = reference::stops(tin, from, to);
    const Walked found = walked(tin, p, q, any_triangle(random, tin));
    RC_ASSERT(found.meets == !wanted.empty());
    RC_ASSERT(found.begins_inside == (wanted.count(0) == 1));
    RC_ASSERT(found.ends_inside == (wanted.count(1) == 1));
    RC_ASSERT(found.stops == std::vector<Rational>(wanted.begin(), wanted.end()));
    for (const LinePiece& piece : found.pieces) {
      check_piece(tin, piece, from, to);
    }
  }
}

RC_GTEST_PROP(LineWalk, KnowsSurfaceFromVoidOnEveryPiece, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Tin tin = reference::random_grid(random, 7, 6, 1, 0.3);
  for (int i = 0; i < 10; ++i) {
    const Spot p = nasty_spot(random, tin);
    const Spot q = nasty_spot(random, tin);
    if (p == q) {
      continue;
    }
    for (const LinePiece& piece : walked(tin, p, q, 0).pieces) {
      const Rational middle =
          (rational_of(piece.from.numerator) / rational_of(piece.from.denominator) +
           rational_of(piece.to.numerator) / rational_of(piece.to.denominator)) /
          2;
      const auto at = reference::triangles_at(tin, along(rational_of(p), rational_of(q), middle));
      RC_ASSERT(piece.is_surface(tin) == std::any_of(at.begin(), at.end(), [&](TriangleId t) {
                  return tin.classes[t] == TriangleClass::kSurface;
                }));
    }
  }
}

TEST(LineWalk, WorksAtTheFarCornersOfTheLargestGrid) {
  Tin tin;
  tin.vertices = {
      {{0, 0}, 0, 0}, {{kGridMax, 0}, 0, 0}, {{kGridMax, kGridMax}, 0, 0}, {{0, kGridMax}, 0, 1}};
  tin.has_height = {1, 1, 1, 1};
  tin.triangles = {{{0, 1, 2}, {kNone, 1, kNone}}, {{0, 2, 3}, {kNone, kNone, 0}}};
  tin.classes.assign(2, TriangleClass::kSurface);
  const Spot p{-kSpotMax, -kSpotMax + 1};
  const Spot q{kSpotMax, kSpotMax};
  const Walked found = walked(tin, p, q, 1);
  const auto wanted = reference::stops(tin, rational_of(p), rational_of(q));
  EXPECT_EQ(found.stops, std::vector<Rational>(wanted.begin(), wanted.end()));
  EXPECT_GE(found.stops.size(), 2u);
}

TEST(SpotMap, GivesVerticesTheirOwnSpots) {
  std::mt19937_64 random(7);
  for (const AffineMap& map : {AffineMap{-125.00013888, 47.0, 1.0 / 3600, 1.0 / 3600},
                               AffineMap{382012.5, 6564011.25, 0.01, 0.01},
                               AffineMap{500000.3, 4000000.1, 30.0, 30.0}, AffineMap{0, 0, 1, 1}}) {
    const GridBox bounds{0, 0, 100000, 1 << 24};
    const SpotMap spots(map, bounds);
    for (int i = 0; i < 20000; ++i) {
      const GridPoint v{static_cast<int>(random() % 100001),
                        static_cast<int>(random() % ((1 << 24) + 1))};
      ASSERT_EQ(spots.spot(map.to_map(v.x, v.y)), spot_of(v));
    }
    EXPECT_FALSE(spots.spot({map.origin_x + 3e9 * map.step_x, map.origin_y}));
  }
}

}  // namespace
}  // namespace ptin
