// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one height of points that fall together.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

/// Merges the heights of points that share a position. For the rule kFirst they are given in the
/// order of the source; else in ascending order, so that their sum does not depend on that.
class MergedHeight {
 public:
  explicit MergedHeight(double first) noexcept
      : first_(first), low_(first), high_(first), sum_(first) {}
  void add(double height) noexcept {
    low_ = std::min(low_, height);
    high_ = std::max(high_, height);
    sum_ += height;
    ++count_;
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// The merged height.
  /// @param whole  Heights are codes: the mean is rounded to a code, ties to even.
  [[nodiscard]] double height(PointMerge rule, bool whole) const noexcept {
    if (rule == PointMerge::kFirst) {
      return first_;
    }
    if (rule != PointMerge::kMean || low_ == high_) {
      return rule == PointMerge::kHighest ? high_ : low_;
    }
    const double mean = sum_ / static_cast<double>(count_);
    return whole ? std::nearbyint(mean) : mean;
  }
  /// The distance of `height` from the farthest of the heights that were merged.
  [[nodiscard]] double shift(double height) const noexcept {
    return std::max(height - low_, high_ - height);
  }

 private:
  double first_, low_, high_, sum_;
  std::uint64_t count_ = 1;
};

}  // namespace ptin
