// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/convex_hull.h"

#include <algorithm>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// The strict corners of the hull of `points`, counter-clockwise from the smallest key. For points
/// on one line: the two ends. For fewer than three distinct points: all of them.
std::vector<GridPoint> hull_of(std::vector<GridPoint> points) {
  std::sort(points.begin(), points.end(),
            [](GridPoint a, GridPoint b) { return key_of(a) < key_of(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) {
    return points;
  }
  std::vector<GridPoint> hull;
  const auto add_chain = [&](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= base + 2 && orient(hull[hull.size() - 2], hull.back(), *p) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();  // the first of the next chain
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

}  // namespace

bool ConvexHull::has_on_border(GridPoint a, GridPoint b) const noexcept {
  // A side with the hull on its left can hold the edge only if both have the same direction.
  const std::size_t n = corners_.size();
  if (n < 3) {
    return false;
  }
  const std::int64_t dx = std::int64_t{b.x} - a.x, dy = std::int64_t{b.y} - a.y;
  // Sides are sorted by direction, from 0 to 360 degrees, since they begin at the lowest corner.
  // The side that is looked for is the first whose direction is not before that of the edge.
  const auto half = [](std::int64_t x, std::int64_t y) {
    return y < 0 || (y == 0 && x < 0) ? 1 : 0;
  };
  const auto is_before = [&](std::size_t side) {
    const GridPoint p = corners_[side], q = corners_[side + 1 == n ? 0 : side + 1];
    const std::int64_t sx = std::int64_t{q.x} - p.x, sy = std::int64_t{q.y} - p.y;
    const int h = half(sx, sy), e = half(dx, dy);
    return h != e ? h < e : sx * dy - sy * dx > 0;
  };
  std::size_t low = 0, high = n;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (is_before(middle)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == n) {
    return false;
  }
  const GridPoint p = corners_[low], q = corners_[low + 1 == n ? 0 : low + 1];
  return orient(p, q, a) == 0 && orient(p, q, b) == 0;
}

bool HullCollector::octagon_holds(GridPoint p) const noexcept {
  if (octagon_.size() < 3) {
    return false;
  }
  for (std::size_t i = 0; i < octagon_.size(); ++i) {
    if (orient(octagon_[i], octagon_[i + 1 == octagon_.size() ? 0 : i + 1], p) < 0) {
      return false;
    }
  }
  return true;
}

void HullCollector::shrink() {
  points_ = hull_of(std::move(points_));
  limit_ = std::max<std::size_t>(4096, 2 * points_.size());
  static constexpr int kDirections[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                            {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  std::vector<GridPoint> octagon;
  for (const auto& d : kDirections) {
    octagon.push_back(
        *std::max_element(points_.begin(), points_.end(), [&](GridPoint a, GridPoint b) {
          return std::int64_t{d[0]} * a.x + std::int64_t{d[1]} * a.y <
                 std::int64_t{d[0]} * b.x + std::int64_t{d[1]} * b.y;
        }));
  }
  octagon_ = hull_of(std::move(octagon));
}

ConvexHull HullCollector::hull() {
  shrink();
  return ConvexHull(points_);
}

}  // namespace ptin
