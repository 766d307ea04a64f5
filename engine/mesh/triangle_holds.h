// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a triangle of a mesh holds a point.
#pragma once

#include "engine/geometry/orient.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// True when `p` lies in the closed triangle, which is one of `tin`. Exact. REQUIRES: the triangle
/// is counter-clockwise. Cost: three orientations.
[[nodiscard]] inline bool triangle_holds(const Tin& tin, const Triangle& triangle,
                                         GridPoint p) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (orient(tin.position(triangle.v[i]), tin.position(triangle.v[next_corner(i)]), p) < 0) {
      return false;
    }
  }
  return true;
}

}  // namespace ptin
