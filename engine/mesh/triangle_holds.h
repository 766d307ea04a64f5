// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a triangle of a mesh holds a point.
#pragma once

#include "engine/geometry/orient.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// True for the closed triangle. Exact. REQUIRES: counter-clockwise. Cost: three orientations.
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
