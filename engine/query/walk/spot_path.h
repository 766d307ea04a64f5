// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of polylines: the region of influence meets one of them.
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

/// True for boxes that share a point with some segment, and errors above a tolerance. Exact, so
/// monotone. Threads: immutable.
class SpotPath final : public AttributePredicate {
 public:
  /// @param segments   One at least; those that lie near each other best follow one another.
  /// @param tolerance  Errors at or below it are left out; negative: none are.
  /// Cost: O(segments); 64 bytes for each besides.
  SpotPath(std::vector<SpotSegment> segments, double tolerance);
  /// A polyline.  @param spots  Two at least. Copied.
  SpotPath(std::span<const Spot> spots, double tolerance);

  /// Cost: constant for boxes that hold a long piece of the line or lie away from it; otherwise the
  /// logarithm of the segments, and those near the box.
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.error > tolerance_ && meets(a.roi);
  }
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
  /// A binary heap of boxes: around node i of a balanced tree over the segments in their order,
  /// children 2 i + 1 and 2 i + 2; leaves hold one segment each.
  std::vector<SpotBox> around_;
  std::size_t first_leaf_ = 0;
};

}  // namespace ptin
