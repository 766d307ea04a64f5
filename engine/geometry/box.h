// SPDX-License-Identifier: GPL-3.0-or-later
//
// Axis-aligned boxes on the grid, closed on all sides.
#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/geometry/point.h"

namespace ptin {

/// A closed box on the grid. Empty when min > max in either coordinate; the default is empty and is
/// the neutral element of united().
struct GridBox {
  std::int32_t min_x = INT32_MAX;
  std::int32_t min_y = INT32_MAX;
  std::int32_t max_x = INT32_MIN;
  std::int32_t max_y = INT32_MIN;
  friend bool operator==(const GridBox&, const GridBox&) = default;
};

[[nodiscard]] constexpr bool is_empty(const GridBox& b) noexcept {
  return b.min_x > b.max_x || b.min_y > b.max_y;
}

[[nodiscard]] constexpr GridBox box_of(GridPoint p) noexcept { return {p.x, p.y, p.x, p.y}; }

[[nodiscard]] constexpr GridBox united(const GridBox& a, const GridBox& b) noexcept {
  return {std::min(a.min_x, b.min_x), std::min(a.min_y, b.min_y), std::max(a.max_x, b.max_x),
          std::max(a.max_y, b.max_y)};
}

/// Empty where they share no position.
[[nodiscard]] constexpr GridBox intersection(const GridBox& a, const GridBox& b) noexcept {
  return {std::max(a.min_x, b.min_x), std::max(a.min_y, b.min_y), std::min(a.max_x, b.max_x),
          std::min(a.max_y, b.max_y)};
}
[[nodiscard]] constexpr GridBox united(const GridBox& a, GridPoint p) noexcept {
  return united(a, box_of(p));
}

/// True when the two closed boxes share a point.
[[nodiscard]] constexpr bool meets(const GridBox& a, const GridBox& b) noexcept {
  return a.min_x <= b.max_x && b.min_x <= a.max_x && a.min_y <= b.max_y && b.min_y <= a.max_y;
}

/// True when `outer` holds every point of `inner`.
[[nodiscard]] constexpr bool contains(const GridBox& outer, const GridBox& inner) noexcept {
  return outer.min_x <= inner.min_x && outer.min_y <= inner.min_y && inner.max_x <= outer.max_x &&
         inner.max_y <= outer.max_y;
}

[[nodiscard]] constexpr bool contains(const GridBox& outer, GridPoint p) noexcept {
  return contains(outer, box_of(p));
}

/// Width plus height, in grid units. REQUIRES: not empty.
[[nodiscard]] constexpr std::int64_t half_perimeter(const GridBox& b) noexcept {
  return (std::int64_t{b.max_x} - b.min_x) + (std::int64_t{b.max_y} - b.min_y);
}

}  // namespace ptin
