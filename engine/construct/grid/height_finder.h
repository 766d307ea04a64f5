// SPDX-License-Identifier: GPL-3.0-or-later
//
// The height encoding of points, found while their heights come one by one.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "engine/construct/grid/height_fit.h"

namespace ptin {

/// Finds the height encoding of points in one pass over their heights. Where heights are codes
/// already (PointGrid::whole), the encoding is int32 with the step of the codes, and only their
/// range is to be found; else HeightScan chooses it. A plain value. Threads: one. Cost: constant a height.
class HeightFinder {
 public:
  /// @param whole  True where add() receives codes: heights in whole steps of `step`. False where
  ///               it receives heights in their own unit.
  /// @param step   The height of one code, in the height's unit; unused unless `whole`.
  constexpr HeightFinder(bool whole, double step) noexcept : whole_(whole), step_(step) {}

  void add(double height) {
    if (whole_) {
      low_ = std::min(low_, height);
      high_ = std::max(high_, height);
    } else {
      scan_.add(height);
    }
  }
  /// Adds the heights that another finder has seen. REQUIRES: both were made alike.
  void join(const HeightFinder& other) {
    scan_.join(other.scan_);
    low_ = std::min(low_, other.low_);
    high_ = std::max(high_, other.high_);
  }
  [[nodiscard]] HeightFit fit() const {
    if (!whole_) {
      return scan_.fit();
    }
    HeightFit fit;
    fit.encoding = {HeightType::int32, step_, 0.0};
    fit.quantum = step_;
    fit.min_height = fit.encoding.height_of_code(low_);
    fit.max_height = fit.encoding.height_of_code(high_);
    return fit;
  }

 private:
  bool whole_;
  std::array<bool, 7> unused_{};  ///< In the place of padding.
  double step_;
  HeightScan scan_{HeightScan::Given::kFloat64};
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

}  // namespace ptin
