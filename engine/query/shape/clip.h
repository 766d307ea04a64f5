// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is common to all cuts of triangles and lines: on which side places lie, what of a convex
// polygon lies on one side, and where a segment crosses a line along an axis. Each is computed from
// the ends in an order of their own, so that two shapes that share an edge get the same bits.
#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

#include "engine/geometry/affine.h"

namespace ptin {

/// Twice the signed area of (o, a, b): > 0 where b lies to the left of o -> a. Rounded.
[[nodiscard]] constexpr double cross(MapPoint o, MapPoint a, MapPoint b) noexcept {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// Goes once around a convex polygon and tells what of it lies on one side of a line (Sutherland and
/// Hodgman, 1974). A corner on the line is kept as it is and nothing is crossed there: so a polygon
/// that is cut twice at one line stays what it is, and no rounding moves a corner that was given.
/// @param at       at(i): on which side corner i lies, > 0 inside, 0 on the line, < 0 outside.
/// @param keep     keep(i): corner i belongs to what is left.
/// @param crossed  crossed(i, j): so does the place where the edge from corner i to corner j crosses
///                 the line. One of the two lies inside, the other one outside.
template <class At, class Keep, class Crossed>
void clip_convex(std::size_t corners, const At& at, const Keep& keep, const Crossed& crossed) {
  for (std::size_t i = 0; i < corners; ++i) {
    const std::size_t j = i + 1 == corners ? 0 : i + 1;
    const auto at_i = at(i), at_j = at(j);
    if (at_i >= 0) keep(i);
    if ((at_i > 0 && at_j < 0) || (at_i < 0 && at_j > 0)) crossed(i, j);
  }
}

/// Where the segment from (au, av) to (bu, bv) meets the line u == at: its v. An end on the line is
/// met exactly; the same bits whichever end comes first.
/// REQUIRES: the segment meets the line.
[[nodiscard]] inline double meet(double au, double av, double bu, double bv, double at) noexcept {
  if (au == at) return av;
  if (bu == at) return bv;
  if (std::tie(bu, bv) < std::tie(au, av)) {
    std::swap(au, bu), std::swap(av, bv);
  }
  return av + (at - au) / (bu - au) * (bv - av);
}

}  // namespace ptin
