// SPDX-License-Identifier: GPL-3.0-or-later
//
// The exact orientation predicate on the grid.
#pragma once

#include <cstdint>

#include "engine/geometry/point.h"

namespace ptin {

/// Twice the signed area of the triangle (a, b, c), exactly: > 0 counter-clockwise, < 0 clockwise,
/// 0 collinear.
///
/// Laws: orient(a, b, c) == orient(b, c, a) == -orient(b, a, c); orient(a, a, c) == 0.
///
/// Bound: coordinates lie in [0, 2^30], so each difference lies in [-2^30, 2^30], each product in
/// [-2^60, 2^60], and the difference of the two products in [-2^61, 2^61], which a signed 64-bit
/// integer holds. No step rounds or overflows. (Twice the area of a triangle in a square of side
/// 2^30 is in fact at most 2^60.)
[[nodiscard]] constexpr std::int64_t orient(GridPoint a, GridPoint b, GridPoint c) noexcept {
  const std::int64_t abx = std::int64_t{b.x} - a.x;
  const std::int64_t aby = std::int64_t{b.y} - a.y;
  const std::int64_t acx = std::int64_t{c.x} - a.x;
  const std::int64_t acy = std::int64_t{c.y} - a.y;
  return abx * acy - aby * acx;
}

}  // namespace ptin
