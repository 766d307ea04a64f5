// SPDX-License-Identifier: GPL-3.0-or-later
//
// The rim of a void, seen across it: the sight line comes through a void triangle, which therefore
// looks at the targets on its sides and corners that are the surface's too.
#pragma once

#include "engine/mesh/tin.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Whether a surface triangle holds a point of the void triangle `t`.
/// @param weights  Of the corners; >= 0. Cost: a corner's degree at a corner, else O(1).
[[nodiscard]] inline bool holds_surface(const Tin& tin, TriangleId t, const double (&weights)[3]) {
  const Triangle& triangle = tin.triangles[t];
  for (int i = 0; i < 3; ++i) {
    if (weights[next_corner(i)] == 0 && weights[previous_corner(i)] == 0) {
      return touches_surface(tin, triangle.v[i]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0) {
      const TriangleId n = triangle.n[i];
      return n != kNone && tin.classes[n] == TriangleClass::kSurface;
    }
  }
  return false;
}

}  // namespace ptin
