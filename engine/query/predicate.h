// SPDX-License-Identifier: GPL-3.0-or-later
//
// The monotone predicates (DESIGN.md, section 2): once true, true for everything larger.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "engine/geometry/affine.h"
#include "storage/attributes.h"

namespace ptin {

/// Regions in map units, closed on all sides.
struct Window {
  double min_x, min_y, max_x, max_y;
};
struct Polygon {
  /// Rings without a repeated last point; the first of each part is its shell, further ones are holes (even-odd rule).
  std::vector<std::vector<MapPoint>> rings;
};
struct Segment {
  MapPoint a, b;
};
using Region = std::variant<Window, MapPoint, Segment, Polygon>;

}  // namespace ptin
