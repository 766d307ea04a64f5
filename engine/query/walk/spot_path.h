// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of polylines: true when the region of influence meets one of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/query/walk/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// A straight piece of a line, closed.
struct SpotSegment {
  Spot a, b;
};

/// True for records whose region of influence shares a point with some segment and whose error is
/// above a tolerance. Exact, so monotone. Threads: immutable.
class SpotPath final : public AttributePredicate {
 public:
  /// @param segments   At least one. Segments that lie near each other should follow one another,
  ///                   since boxes are put around neighbours in this order.
  /// @param tolerance  Records of an error at or below it are left out; negative: none are.
  /// Cost: O(segments) time. Memory besides the segments: two to three boxes of 32 bytes for each.
  SpotPath(std::vector<SpotSegment> segments, double tolerance);
  /// The segments of one polyline.  @param spots  At least two. Copied.
  SpotPath(std::span<const Spot> spots, double tolerance);

  /// Cost: constant for a box that holds a long piece of the line or lies away from the line;
  /// otherwise logarithmic in the segments, plus the segments near the box.
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.error > tolerance_ && meets(a.roi);
  }
  /// True when the closed box (grid units) shares a point with some segment. Exact. Cost: as
  /// holds().
  [[nodiscard]] bool meets(const GridBox& box) const noexcept;

 private:
  /// Closed, in spot units.
  struct SpotBox {
    std::int64_t min_x, min_y, max_x, max_y;
  };
  [[nodiscard]] bool segment_meets(std::size_t segment, const SpotBox& box,
                                   const GridBox& grid) const noexcept;

  double tolerance_;
  std::vector<SpotSegment> segments_;
  /// Boxes of a balanced binary tree over the segments in their order. Node i has the children
  /// 2 i + 1 and 2 i + 2, and its box holds theirs; a leaf holds one segment.
  std::vector<SpotBox> around_;
  std::size_t first_leaf_ = 0;
};

}  // namespace ptin
