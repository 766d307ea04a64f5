// SPDX-License-Identifier: GPL-3.0-or-later
//
// Closed intervals of height codes.
#pragma once

#include <algorithm>
#include <limits>

namespace ptin {

/// A closed interval [lo, hi] of heights (codes or heights: the place that holds one says which).
/// Empty when lo > hi; the default is empty and is the neutral element of united().
struct Interval {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
  friend bool operator==(const Interval&, const Interval&) = default;
};

[[nodiscard]] constexpr bool is_empty(const Interval& i) noexcept { return i.lo > i.hi; }
[[nodiscard]] constexpr Interval united(const Interval& a, const Interval& b) noexcept {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
[[nodiscard]] constexpr Interval united(const Interval& a, double v) noexcept {
  return united(a, Interval{v, v});
}
[[nodiscard]] constexpr bool contains(const Interval& i, double v) noexcept {
  return i.lo <= v && v <= i.hi;
}
[[nodiscard]] constexpr bool contains(const Interval& outer, const Interval& inner) noexcept {
  return is_empty(inner) || (outer.lo <= inner.lo && inner.hi <= outer.hi);
}
[[nodiscard]] constexpr bool meets(const Interval& a, const Interval& b) noexcept {
  return a.lo <= b.hi && b.lo <= a.hi;
}

}  // namespace ptin
