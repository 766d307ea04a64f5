// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the codes or heights of points are, found while they come.
#pragma once

#include <algorithm>
#include <limits>

#include "engine/construct/grid/height_fit.h"

namespace ptin {

/// The height encoding of points that come one by one. Threads: one. Cost: constant a height.
class HeightFinder {
 public:
  /// @param whole  Heights are codes: whole steps of `step` (PointGrid).
  /// @param step  Of a code, map units of height.
  HeightFinder(bool whole, double step) : whole_(whole), step_(step) {}

  void add(double height) {
    if (whole_) {
      low_ = std::min(low_, height);
      high_ = std::max(high_, height);
    } else {
      scan_.add(height);
    }
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
  double step_;
  HeightScan scan_{HeightScan::Given::kFloat64};
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

}  // namespace ptin
