// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles that live at a level of detail: those of its TIN, by lifetimes alone (engine/DESIGN.md,
// section 2.10).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/geometry/box.h"
#include "engine/geometry/infinity.h"
#include "engine/geometry/interval.h"
#include "engine/mesh/tin.h"
#include "engine/query/living/living_stars.h"
#include "storage/coarsest_tin.h"

namespace ptin {

/// A triangle with what its maker says of the full surface below it: every record that refines the
/// triangle depends on its maker.
struct LivingTriangle {
  struct Corner {
    GridPoint position;
    HeightBits height = 0;
    bool has_height = false;
  };
  std::array<Corner, 3> corner;  ///< Counter-clockwise.
  bool is_void = false;
  bool is_tied = false;  ///< It dies at the level's own error: LivingTies tells whether it lives.
  /// Most vertical distance to the full surface where both are surface, height's unit; +infinity
  /// for a triangle of T0.
  double deviation = kInfinity;
  Interval heights{-kInfinity, kInfinity};  ///< Codes of the full surface; empty: nothing but void.
};

[[nodiscard]] inline GridBox box_of(const LivingTriangle& t) noexcept {
  return united(united(box_of(t.corner[0].position), t.corner[1].position), t.corner[2].position);
}

/// The same triangle with the corner of least key first: what is computed from its corners in order is
/// then the same in every bit, however the triangle was found.
[[nodiscard]] inline LivingTriangle begun_with_least(LivingTriangle t) noexcept {
  const auto by_key = [](const LivingTriangle::Corner& a, const LivingTriangle::Corner& b) {
    return key_of(a.position) < key_of(b.position);
  };
  std::rotate(t.corner.begin(), std::min_element(t.corner.begin(), t.corner.end(), by_key),
              t.corner.end());
  return t;
}

/// A triangle of a mesh, of whose maker nothing is known.
[[nodiscard]] inline LivingTriangle living_triangle(const Tin& tin, TriangleId t) {
  LivingTriangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    triangle.corner[i] = {tin.position(v), tin.vertices[v].height, tin.has_height[v] != 0};
  }
  triangle.is_void = tin.classes[t] == TriangleClass::kVoid;
  return triangle;
}

/// Calls visit(const LivingTriangle&) for each triangle that lives and whose box is wanted:
/// wants(const GridBox&).
template <class Wants, class Visit>
void visit_living(const LivingStars& living, const HeightEncoding& heights, const Wants& wants,
                  const Visit& visit) {
  const LivingCorner* corner = living.corners.data();
  for (std::size_t i = 0; i < living.stars.size(); ++i) {
    const LivingStar& star = living.stars.data()[i];
    LivingTriangle t;
    t.corner[0] = {star.u, star.height, star.has_height};
    t.deviation = star.deviation;
    t.heights = {heights.code(star.height_lo), heights.code(star.height_hi)};
    const auto corner_of = [](const LivingCorner& c) {
      return LivingTriangle::Corner{c.position, c.height, (c.flags & LivingCorner::kNoHeight) == 0};
    };
    const LivingCorner* const end = living.corners.data() + star.corner_end;
    for (; corner != end; ++corner) {
      if ((corner->flags & LivingCorner::kLives) != 0 &&
          wants(united(united(box_of(star.u), corner[0].position), corner[1].position))) {
        t.corner[1] = corner_of(corner[0]);
        t.corner[2] = corner_of(corner[1]);
        t.is_void = (corner->flags & LivingCorner::kVoid) != 0;
        t.is_tied = (corner->flags & LivingCorner::kTied) != 0;
        visit(t);
      }
    }
  }
}

/// The same for each triangle that lives.
template <class Visit>
void visit_living(const LivingStars& living, const HeightEncoding& heights, const Visit& visit) {
  visit_living(
      living, heights, [](const GridBox&) { return true; }, visit);
}

/// The same for the triangles of T0, which live where they die at the level or below it (negative:
/// never).
template <class Visit>
void visit_living(const CoarsestTin& t0, double level, const Visit& visit) {
  for (const CoarsestTin::T& triangle : t0.triangles) {
    if (triangle.death <= level) {
      LivingTriangle t;
      for (std::size_t i = 0; i < 3; ++i) {
        const CoarsestTin::V& v = t0.vertices[triangle.v[i]];
        t.corner[i] = {v.position, v.height, v.has_height != 0};
      }
      t.is_void = triangle.is_void != 0;
      t.is_tied = static_cast<double>(triangle.death) == level;
      visit(t);
    }
  }
}

}  // namespace ptin
