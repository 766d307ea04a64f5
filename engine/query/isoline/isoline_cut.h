// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where an isoline crosses an edge: one function, so that every caller gets the same bits.
#pragma once

#include <compare>

#include "engine/geometry/affine.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The edge that an isoline crosses, by the keys of its ends: `below` lies under the level, `above`
/// at or above it.
struct CutEdge {
  VertexKey below = kNoVertexKey;
  VertexKey above = kNoVertexKey;
  friend auto operator<=>(const CutEdge&, const CutEdge&) = default;
};

/// An end of an edge in the plane, with its height code.
struct CutEnd {
  double x, y, code;
};

/// The point at height `level` (a code) on an edge, in grid units as the ends are. It is
/// interpolated from the lower end to the higher one and depends on the edge and the level alone,
/// so every triangle, tile and window gets the same bits. At the code of the higher end it is that
/// end exactly.
/// REQUIRES: below.code < level <= above.code.
[[nodiscard]] inline MapPoint cut_of(const CutEnd& below, const CutEnd& above,
                                     double level) noexcept {
  if (level == above.code) {
    return {above.x, above.y};
  }
  const double t = (level - below.code) / (above.code - below.code);
  return {below.x + t * (above.x - below.x), below.y + t * (above.y - below.y)};
}

/// The side through which an isoline with higher ground on its right enters a triangle: walked
/// counter-clockwise, the side rises from below the level to above it.
/// @param above  For each corner whether it is above the level. REQUIRES: neither all nor none.
/// Returns the corner opposite to the side, as Triangle::n is numbered.
[[nodiscard]] constexpr int entry_side(const bool (&above)[3]) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (!above[next_corner(i)] && above[previous_corner(i)]) {
      return i;
    }
  }
  return 0;
}

/// Likewise the side through which the isoline leaves the triangle: the one that falls.
[[nodiscard]] constexpr int exit_side(const bool (&above)[3]) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (above[next_corner(i)] && !above[previous_corner(i)]) {
      return i;
    }
  }
  return 0;
}

}  // namespace ptin
