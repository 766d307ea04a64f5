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
#include <utility>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/circumdisc.h"
#include "engine/geometry/orient.h"

namespace ptin::delaunay_internal {

/// A closed triangle, or the closed half-plane to the left of one side, by its sides.
class Part {
 public:
  /// REQUIRES: orient(a, b, c) > 0.
  Part(GridPoint a, GridPoint b, GridPoint c) : ends_{a, b, c}, sides_(3) {}
  Part(GridPoint a, GridPoint b) : ends_{a, b, a}, sides_(1) {}

  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    return all_sides([&](GridPoint a, GridPoint b) { return orient(a, b, p) >= 0; });
  }
  /// True when the part and the box have a point in common; now and then also where they have none.
  [[nodiscard]] bool may_meet(const GridBox& box) const noexcept {
    return all_sides([&](GridPoint a, GridPoint b) {
      // The corner farthest to the left.
      return orient(a, b, {b.y < a.y ? box.max_x : box.min_x, b.x > a.x ? box.max_y : box.min_y}) >=
             0;
    });
  }

 private:
  template <class Holds>
  [[nodiscard]] bool all_sides(const Holds& holds) const {
    for (std::size_t i = 0; i < sides_; ++i) {
      if (!holds(ends_[i], ends_[i + 1 == ends_.size() ? 0 : i + 1])) {
        return false;
      }
    }
    return true;
  }
  std::array<GridPoint, 3> ends_;
  std::size_t sides_;
};

/// The region in which no point may be unseen (not inserted) for a face to be final. For a finite
/// face it is the closed circumdisc, or where fixed edges may hide some of it, certain parts of that.
/// For an infinite one, beyond an edge of the hull, it is the open half-plane outside of the edge, and
/// the edge itself.
class UnseenRegion {
 public:
  /// The region of a finite face.
  explicit UnseenRegion(const Circumdisc& disc) : disc_(disc) {}
  /// The region of a finite face of which no more is visible than the parts hold.
  UnseenRegion(const Circumdisc& disc, std::vector<Part> visible)
      : disc_(disc), visible_(std::move(visible)) {}
  /// The region of an infinite face, to the right of a -> b.
  UnseenRegion(GridPoint a, GridPoint b) : a_(a), b_(b) {}

  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    if (disc_) {
      return disc_->holds(p) && is_visible([&](const Part& part) { return part.holds(p); });
    }
    const std::int64_t side = orient(a_, b_, p);
    return side < 0 || (side == 0 && contains(united(box_of(a_), b_), p));
  }
  /// True when the box and the region have a point in common; also where they only just miss each
  /// other.
  [[nodiscard]] bool may_meet(const GridBox& box) const noexcept {
    if (disc_) {
      return disc_->may_meet(box) &&
             is_visible([&](const Part& part) { return part.may_meet(box); });
    }
    const GridPoint corner{b_.y - a_.y > 0 ? box.max_x : box.min_x,
                           b_.x - a_.x > 0 ? box.min_y : box.max_y};
    const std::int64_t side = orient(a_, b_, corner);  // the corner farthest to the right
    return side < 0 || (side == 0 && meets(united(box_of(a_), b_), box));
  }

 private:
  template <class Holds>
  [[nodiscard]] bool is_visible(const Holds& holds) const {
    return visible_.empty() || std::any_of(visible_.begin(), visible_.end(), holds);
  }
  std::optional<Circumdisc> disc_;  ///< None: the edge a_ -> b_.
  std::vector<Part> visible_;       ///< Empty: all of the disc.
  GridPoint a_, b_;
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
