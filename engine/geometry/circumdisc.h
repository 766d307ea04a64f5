// SPDX-License-Identifier: GPL-3.0-or-later
//
// The closed disc through three grid points, asked exactly.
#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/geometry/box.h"
#include "engine/geometry/orient.h"
#include "engine/geometry/point.h"

namespace ptin {

/// The closed disc whose border passes through three points.
///
/// With a as the origin the points of the disc are those where f(p) = A p^2 - U p.x - V p.y <= 0,
/// for A = orient(a, b, c), U = b^2 c.y - c^2 b.y, V = b.x c^2 - c.x b^2 (f is 0 at a, b and c).
/// Bounds: differences of grid coordinates lie in [-2^30, 2^30], so A <= 2^61, squares <= 2^61,
/// |U|, |V| <= 2^92, and each term of f is at most 2^123: 128 bits hold it. Nothing is rounded.
class Circumdisc {
 public:
  __extension__ using Int128 = __int128;

  /// REQUIRES: orient(a, b, c) > 0.
  Circumdisc(GridPoint a, GridPoint b, GridPoint c) noexcept : a_(a), area_(orient(a, b, c)) {
    const std::int64_t bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
    const std::int64_t cx = std::int64_t{c.x} - a.x, cy = std::int64_t{c.y} - a.y;
    const std::int64_t b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    u_ = Int128{b2} * cy - Int128{c2} * by;
    v_ = Int128{c2} * bx - Int128{b2} * cx;
    centre_x_ = nearest_whole(u_);
    centre_y_ = nearest_whole(v_);
  }

  /// True when `p` lies inside or on the circle.
  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    return along(std::int64_t{p.x} - a_.x, u_) + along(std::int64_t{p.y} - a_.y, v_) <= 0;
  }

  /// True when the disc and the closed box have a point in common, on the grid or between. May also
  /// be true when they have none, but pass each other within a grid unit.
  [[nodiscard]] bool may_meet(const GridBox& box) const noexcept {
    return least(box.min_x - std::int64_t{a_.x}, box.max_x - std::int64_t{a_.x}, centre_x_, u_) +
               least(box.min_y - std::int64_t{a_.y}, box.max_y - std::int64_t{a_.y}, centre_y_,
                     v_) <=
           0;
  }

 private:
  /// The whole number next to t / (2 A), where the parabola A x^2 - t x is lowest.
  [[nodiscard]] std::int64_t nearest_whole(Int128 t) const noexcept {
    static constexpr std::int64_t kFar = std::int64_t{1} << 40;
    const Int128 twice = 2 * Int128{area_};
    const Int128 whole = (t >= 0 ? t + area_ : t - area_) / twice;
    return static_cast<std::int64_t>(std::clamp<Int128>(whole, -kFar, kFar));
  }
  [[nodiscard]] Int128 along(std::int64_t x, Int128 t) const noexcept {
    return Int128{area_} * (x * x) - t * x;
  }
  /// A lower bound of the parabola A x^2 - t x over [low, high]. `lowest_at` is the whole number
  /// nearest to its lowest point; the parabola goes at most A / 4 below its value there.
  [[nodiscard]] Int128 least(std::int64_t low, std::int64_t high, std::int64_t lowest_at,
                             Int128 t) const noexcept {
    const std::int64_t x = std::clamp(lowest_at, low, high);
    return along(x, t) - (x == lowest_at ? area_ : 0);
  }

  GridPoint a_;
  std::int64_t area_;
  Int128 u_ = 0, v_ = 0;
  std::int64_t centre_x_ = 0, centre_y_ = 0;  ///< The centre, relative to a; clamped far off.
};

}  // namespace ptin
