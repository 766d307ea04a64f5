// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of polylines: true when the roi of a record meets one of them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/query/shape/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// A straight piece of a line, closed.
struct SpotSegment {
  Spot a, b;
};

/// Segments, to be asked which of them a box meets. For pages of stars: true where their box meets
/// some segment. Exact. Threads: immutable.
class SpotPath final : public StarPredicate {
 public:
  /// @param segments  At least one. Segments that lie near each other should follow one another,
  ///                  since boxes are put around neighbours in this order.
  /// Cost: O(segments) time. Memory besides the segments: two to three boxes of 32 bytes for each.
  explicit SpotPath(std::vector<SpotSegment> segments);

  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return meets(a.box);
  }
  [[nodiscard]] GridBox reach() const noexcept override { return bounds(); }
  /// True when the closed box (grid units) shares a point with some segment. Exact. Cost: constant
  /// for a box that holds a long piece of the line or lies away from the line; otherwise
  /// logarithmic in the segments, plus the segments near the box.
  [[nodiscard]] bool meets(const GridBox& box) const noexcept;
  /// Calls visit(number) for each segment that shares a point with the box. Cost: logarithmic in the
  /// segments, plus those near the box.
  template <class Visit>
  void visit(const GridBox& box, const Visit& visit) const {
    descend(
        box, [](const SpotBox&) { return false; },
        [&](std::size_t segment) {
          visit(segment);
          return false;
        });
  }
  [[nodiscard]] const SpotSegment& segment(std::size_t i) const noexcept { return segments_[i]; }
  /// A box (grid units) around all segments.
  [[nodiscard]] GridBox bounds() const noexcept;

 private:
  /// Closed, in spot units.
  struct SpotBox {
    std::int64_t min_x, min_y, max_x, max_y;
  };
  [[nodiscard]] static SpotBox spot_box(const GridBox& grid) noexcept {
    const Spot low = spot_of(GridPoint{grid.min_x, grid.min_y});
    const Spot high = spot_of(GridPoint{grid.max_x, grid.max_y});
    return {low.x, low.y, high.x, high.y};
  }
  /// Goes through the segments that meet a box until `take` returns true of one, or `is_enough` of a
  /// box around some that lies within.
  template <class IsEnough, class Take>
  bool descend(const GridBox& grid, const IsEnough& is_enough, const Take& take) const;
  [[nodiscard]] bool segment_meets(std::size_t segment, const SpotBox& box,
                                   const GridBox& grid) const noexcept;

  std::vector<SpotSegment> segments_;
  /// Boxes of a balanced binary tree over the segments in their order. Node i has the children
  /// 2 i + 1 and 2 i + 2, and its box holds theirs; a leaf holds one segment.
  std::vector<SpotBox> around_;
  std::size_t first_leaf_ = 0;
};

template <class IsEnough, class Take>
bool SpotPath::descend(const GridBox& grid, const IsEnough& is_enough, const Take& take) const {
  const SpotBox box = spot_box(grid);
  std::array<std::size_t, 128> waiting;  // At most two nodes of a level wait.
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count != 0) {
    const std::size_t i = waiting[--count];
    const SpotBox& b = around_[i];
    if (b.max_x < box.min_x || box.max_x < b.min_x || b.max_y < box.min_y || box.max_y < b.min_y) {
      continue;  // ends here for a node without segments too: its box is inverted
    }
    const bool is_within = box.min_x <= b.min_x && b.max_x <= box.max_x && box.min_y <= b.min_y &&
                           b.max_y <= box.max_y;
    if (is_within && is_enough(b)) {
      return true;
    }
    if (i >= first_leaf_) {
      if (segment_meets(i - first_leaf_, box, grid) && take(i - first_leaf_)) {
        return true;
      }
      continue;
    }
    for (const std::size_t child : {2 * i + 2, 2 * i + 1}) {
      if (child < around_.size()) waiting[count++] = child;
    }
  }
  return false;
}

}  // namespace ptin
