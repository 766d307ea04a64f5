// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of a polyline: the region of influence meets it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/query/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// True for boxes that share a point with a polyline, and errors above a tolerance. Exact, so
/// monotone. Threads: immutable.
class SpotPath final : public AttributePredicate {
 public:
  /// @param spots      Two at least. Copied.
  /// @param tolerance  Errors at or below it are left out; negative: none are.
  /// Cost: O(spots); 32 bytes more for each.
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
  std::vector<Spot> spots_;
  /// A binary heap of boxes: around node i of a balanced tree over the segments in their order,
  /// children 2 i + 1 and 2 i + 2; leaves hold one segment each.
  std::vector<SpotBox> around_;
  std::size_t first_leaf_ = 0;
};

}  // namespace ptin
