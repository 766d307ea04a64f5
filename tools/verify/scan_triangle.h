// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which samples a triangle holds, in integers; for verification.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin::tools {

/// Where a grid point lies in relation to a triangle.
struct Weights {
  /// w[i]: twice the area of (next corner, previous corner, point) for corner i. Their sum is twice
  /// the area of the triangle.
  std::array<std::int64_t, 3> w{};
  [[nodiscard]] bool in_closed() const { return w[0] >= 0 && w[1] >= 0 && w[2] >= 0; }
  [[nodiscard]] bool in_open() const { return w[0] > 0 && w[1] > 0 && w[2] > 0; }
};

/// The line through two corners, as the number `a * x + b * y + c`, which is > 0 on the inner side.
/// Its absolute value is at most 2^61 on the grid.
struct EdgeLine {
  std::int64_t a, b, c;
  EdgeLine(GridPoint p, GridPoint q)
      : a(std::int64_t{p.y} - q.y), b(std::int64_t{q.x} - p.x), c(-(a * p.x) - b * p.y) {}
  [[nodiscard]] std::int64_t at(std::int64_t x, std::int64_t y) const { return a * x + b * y + c; }
};

[[nodiscard]] inline std::array<EdgeLine, 3> edge_lines(const std::array<GridPoint, 3>& t) {
  return {EdgeLine(t[1], t[2]), EdgeLine(t[2], t[0]), EdgeLine(t[0], t[1])};
}

[[nodiscard]] inline Weights weights_at(const std::array<EdgeLine, 3>& lines, GridPoint p) {
  return {{lines[0].at(p.x, p.y), lines[1].at(p.x, p.y), lines[2].at(p.x, p.y)}};
}

/// The columns of row `y` in [low, high] that lie in the closed triangle, as a closed interval;
/// empty when first > second.
[[nodiscard]] inline std::array<std::int64_t, 2> columns_in(const std::array<EdgeLine, 3>& lines,
                                                            std::int64_t y, std::int64_t low,
                                                            std::int64_t high) {
  for (const EdgeLine& line : lines) {
    const std::int64_t rest = line.b * y + line.c;  // a * x + rest >= 0
    if (line.a == 0) {
      if (rest < 0) return {1, 0};
    } else if (line.a > 0) {  // x >= -rest / a, rounded up
      const std::int64_t q = -rest / line.a;
      low = std::max(low, q + ((-rest) % line.a > 0 ? 1 : 0));
    } else {  // x <= rest / -a, rounded down
      const std::int64_t q = rest / -line.a;
      high = std::min(high, q - (rest % -line.a < 0 ? 1 : 0));
    }
  }
  return {low, high};
}

/// Calls `visit(x, y)` for every grid point of `box` in the closed triangle `t`
/// (counter-clockwise).
template <typename Visit>
void scan_triangle(const std::array<GridPoint, 3>& t, const GridBox& box, const Visit& visit) {
  const auto lines = edge_lines(t);
  const std::int32_t low_y = std::max(box.min_y, std::min({t[0].y, t[1].y, t[2].y}));
  const std::int32_t high_y = std::min(box.max_y, std::max({t[0].y, t[1].y, t[2].y}));
  for (std::int32_t y = low_y; y <= high_y; ++y) {
    const auto [first, last] = columns_in(lines, y, box.min_x, box.max_x);
    for (std::int64_t x = first; x <= last; ++x) visit(static_cast<std::int32_t>(x), y);
  }
}

}  // namespace ptin::tools
