// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a point that was not inserted would change a face of a Delaunay triangulation. For
// delaunay/growing_delaunay.cc.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "engine/geometry/box.h"
#include "engine/geometry/circumdisc.h"
#include "engine/geometry/orient.h"

namespace ptin::delaunay_internal {

/// The region in which no point may be unseen (not inserted) for a face to be final. For a finite
/// face it is the closed circumdisc, without what lies beyond a fixed side of the face: the line
/// through the side meets the disc in the side alone, so nothing beyond is visible from the face. For
/// an infinite one, beyond an edge of the hull, it is the
/// open half-plane outside of the edge, and the edge itself.
class UnseenRegion {
 public:
  /// The region of a finite face.
  explicit UnseenRegion(const Circumdisc& disc) : disc_(disc) {}
  /// Takes away what lies to the right of a -> b, a fixed side of the finite face.
  void hide_beyond(GridPoint a, GridPoint b) {
    sides_[static_cast<std::size_t>(hidden_++)] = {a, b};
  }
  /// The region of an infinite face, to the right of a -> b.
  UnseenRegion(GridPoint a, GridPoint b) : a_(a), b_(b) {}

  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    if (disc_) {
      return disc_->holds(p) && std::all_of(sides_.begin(), sides_.begin() + hidden_,
                                            [&](auto s) { return orient(s.a, s.b, p) >= 0; });
    }
    const std::int64_t side = orient(a_, b_, p);
    return side < 0 || (side == 0 && contains(united(box_of(a_), b_), p));
  }
  /// True when the box and the region have a point in common; also where they only just miss each
  /// other.
  [[nodiscard]] bool may_meet(const GridBox& box) const noexcept {
    if (disc_) {
      return disc_->may_meet(box) &&
             std::all_of(sides_.begin(), sides_.begin() + hidden_, [&](auto s) {
               const GridPoint left{s.b.y - s.a.y < 0 ? box.max_x : box.min_x,
                                    s.b.x - s.a.x > 0 ? box.max_y : box.min_y};
               return orient(s.a, s.b, left) >= 0;  // the corner farthest to the left
             });
    }
    const GridPoint corner{b_.y - a_.y > 0 ? box.max_x : box.min_x,
                           b_.x - a_.x > 0 ? box.min_y : box.max_y};
    const std::int64_t side = orient(a_, b_, corner);  // the corner farthest to the right
    return side < 0 || (side == 0 && meets(united(box_of(a_), b_), box));
  }

 private:
  std::optional<Circumdisc> disc_;  ///< None: the edge a_ -> b_.
  GridPoint a_, b_;
  struct Side {
    GridPoint a, b;
  };
  std::array<Side, 3> sides_{};  ///< The first hidden_ ones.
  int hidden_ = 0;
};

/// True only when the closed circumdisc of a triangle lies inside of the box. Computed in doubles,
/// so it may be false where the disc only just does.
inline bool disc_lies_in(const GridBox& box, GridPoint a, GridPoint b, GridPoint c) noexcept {
  const double bx = static_cast<double>(b.x) - a.x, by = static_cast<double>(b.y) - a.y;
  const double cx = static_cast<double>(c.x) - a.x, cy = static_cast<double>(c.y) - a.y;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double twice = 2.0 * static_cast<double>(orient(a, b, c));
  const double ux = (b2 * cy - c2 * by) / twice, uy = (c2 * bx - b2 * cx) / twice;
  // Each of b2, c2, the products and their difference, and the quotient is rounded once: below
  // 2^-50 of the sizes of the terms.
  const double slack =
      0x1p-49 * (b2 + c2) * (std::abs(bx) + std::abs(by) + std::abs(cx) + std::abs(cy)) / twice;
  const double radius = std::sqrt(ux * ux + uy * uy) * (1.0 + 0x1p-50) + 2.0 * slack + 0x1p-20;
  return a.x + ux - radius > box.min_x && a.x + ux + radius < box.max_x &&
         a.y + uy - radius > box.min_y && a.y + uy + radius < box.max_y;
}

}  // namespace ptin::delaunay_internal
