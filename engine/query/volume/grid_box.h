// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes of whole positions around what lies between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"

namespace ptin {

/// A position as doubles, exact.
[[nodiscard]] inline MapPoint position_of(GridPoint p) noexcept {
  return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

/// The box from `low` to `high`, rounded outward and cut to what 32 bits hold.
[[nodiscard]] inline GridBox box_between(MapPoint low, MapPoint high) noexcept {
  const auto whole = [](double v) {
    return static_cast<std::int32_t>(std::clamp(v, -2147483648.0, 2147483647.0));
  };
  return {whole(std::floor(low.x)), whole(std::floor(low.y)), whole(std::ceil(high.x)),
          whole(std::ceil(high.y))};
}

/// The box around points, as box_between(). REQUIRES: a point.
[[nodiscard]] inline GridBox box_around(std::span<const MapPoint> points) noexcept {
  MapPoint low = points.front(), high = low;
  for (const MapPoint p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return box_between(low, high);
}

/// The box widened on all sides, as box_between().
[[nodiscard]] inline GridBox widened(const GridBox& box, MapPoint reach) noexcept {
  return box_between({box.min_x - reach.x, box.min_y - reach.y},
                     {box.max_x + reach.x, box.max_y + reach.y});
}

}  // namespace ptin
