// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "engine/error.h"
#include "engine/geometry/affine_rounding.h"
#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;  // unit roundoff u = 2^-53
constexpr double kFarthest = 1e100;                                   // products of two stay finite

/// One coordinate of a map position on the grid, and how far the true one may be away.
double to_grid(double map_value, double origin, double step, double& slack) {
  const double grid = (map_value - origin) / step;
  slack = rounding_to_grid(map_value, origin, step, grid);
  if (!(std::abs(grid) <= kFarthest) || !(slack <= kFarthest)) {
    refuse("a coordinate of the region is not a finite number near the terrain");
  }
  return grid;
}

/// True when twice the signed area of (a, b, (x, y)) lies surely below zero.
/// Rounding: each product carries at most 3u of itself, their difference u more; `reach` is what a
/// displacement of (x, y) adds. Eight u of the products' sizes and twice `reach` is twice the
/// bound.
bool surely_right(GridPoint a, GridPoint b, double x, double y, double slack_x,
                  double slack_y) noexcept {
  const double abx = static_cast<double>(b.x) - a.x;
  const double aby = static_cast<double>(b.y) - a.y;
  const double p = abx * (y - a.y);
  const double q = aby * (x - a.x);
  const double reach = std::abs(abx) * slack_y + std::abs(aby) * slack_x;
  return p - q < -(8 * kUnit * (std::abs(p) + std::abs(q)) + 2 * reach);
}

GridBox box_of(const GridPoint (&t)[3]) noexcept {
  return united(united(ptin::box_of(t[0]), t[1]), t[2]);
}

}  // namespace

GridWindow on_grid(const Window& window, const AffineMap& map) noexcept {
  return {snapped_to_grid(window.min_x, map.origin_x, map.step_x),
          snapped_to_grid(window.min_y, map.origin_y, map.step_y),
          snapped_to_grid(window.max_x, map.origin_x, map.step_x),
          snapped_to_grid(window.max_y, map.origin_y, map.step_y)};
}

Window snapped(const Window& window, const AffineMap& map) noexcept {
  const auto at = [](double map_value, double origin, double step) {
    const double grid = snapped_to_grid(map_value, origin, step);
    return grid == std::round(grid) && std::abs(grid) <= kGridMax ? origin + step * grid
                                                                  : map_value;
  };
  return {at(window.min_x, map.origin_x, map.step_x), at(window.min_y, map.origin_y, map.step_y),
          at(window.max_x, map.origin_x, map.step_x), at(window.max_y, map.origin_y, map.step_y)};
}

GridRegion::GridRegion(const Region& region, const AffineMap& map) {
  if (const auto* window = std::get_if<Window>(&region)) {
    if (!(window->min_x <= window->max_x && window->min_y <= window->max_y)) {
      refuse("the window is inverted or not a number: expected min_x <= max_x and min_y <= max_y");
    }
    set_rectangle(widened({window->min_x, window->min_y}, map),
                  widened({window->max_x, window->max_y}, map));
    hold(on_grid(*window, map));
  } else if (const auto* point = std::get_if<MapPoint>(&region)) {
    set_rectangle(widened(*point, map), widened(*point, map));
  } else if (const auto* segment = std::get_if<Segment>(&region)) {
    kind_ = Kind::kSegment;
    add_edge(widened(segment->a, map), widened(segment->b, map));
    sort_edges_into_bins();
  } else {
    kind_ = Kind::kPolygon;
    const auto& rings = std::get<Polygon>(region).rings;
    if (rings.empty()) {
      refuse("the polygon has no ring");
    }
    for (const auto& ring : rings) {
      add_ring(ring, map);
    }
    sort_edges_into_bins();
  }
}

GridRegion::WidenedPoint GridRegion::widened(MapPoint p, const AffineMap& map) {
  WidenedPoint point{};
  point.x = to_grid(p.x, map.origin_x, map.step_x, point.slack_x);
  point.y = to_grid(p.y, map.origin_y, map.step_y, point.slack_y);
  return point;
}

void GridRegion::set_rectangle(const WidenedPoint& low, const WidenedPoint& high) {
  kind_ = Kind::kRectangle;
  min_x_ = low.x - low.slack_x;
  min_y_ = low.y - low.slack_y;
  max_x_ = high.x + high.slack_x;
  max_y_ = high.y + high.slack_y;
}

void GridRegion::hold(const GridWindow& window) noexcept {
  min_x_ = std::min(min_x_, window.min_x), max_x_ = std::max(max_x_, window.max_x);
  min_y_ = std::min(min_y_, window.min_y), max_y_ = std::max(max_y_, window.max_y);
}

/// The line function's rounding, for corners on the grid: with t1 = nx (x - ax) and t2 = ny (y -
/// ay), differences, products and sum carry at most 4u (|t1| + |t2|) (1 + O(u)); ends that are
/// displaced move it by |nx| slack_x + |ny| slack_y. Twice the sum of both is taken, at the largest
/// |x - ax| and |y - ay| that the grid allows.
void GridRegion::add_edge(const WidenedPoint& a, const WidenedPoint& b) {
  Edge e{};
  e.ax = a.x, e.ay = a.y, e.bx = b.x, e.by = b.y;
  e.slack_x = std::max(a.slack_x, b.slack_x);
  e.slack_y = std::max(a.slack_y, b.slack_y);
  e.min_x = std::min(a.x, b.x) - e.slack_x;
  e.max_x = std::max(a.x, b.x) + e.slack_x;
  e.min_y = std::min(a.y, b.y) - e.slack_y;
  e.max_y = std::max(a.y, b.y) + e.slack_y;
  e.nx = b.y - a.y;
  e.ny = a.x - b.x;
  const double far_x = std::max(std::abs(a.x), std::abs(kGridMax - a.x));
  const double far_y = std::max(std::abs(a.y), std::abs(kGridMax - a.y));
  e.slack = 8 * kUnit * (std::abs(e.nx) * far_x + std::abs(e.ny) * far_y) +
            2 * (std::abs(e.nx) * e.slack_x + std::abs(e.ny) * e.slack_y);
  const double longer = std::max(std::abs(e.nx), std::abs(e.ny));
  widening_ = std::max({widening_, e.slack_x, e.slack_y, longer > 0 ? e.slack / longer : 0.0});
  edges_.push_back(e);
}

void GridRegion::add_ring(const std::vector<MapPoint>& ring, const AffineMap& map) {
  std::size_t size = ring.size();
  if (size > 1 && ring.front() == ring.back()) {
    --size;
  }
  if (size < 3) {
    refuse("a ring of the polygon has fewer than three points");
  }
  for (std::size_t i = 0; i < size; ++i) {
    add_edge(widened(ring[i], map), widened(ring[i + 1 == size ? 0 : i + 1], map));
  }
}

void GridRegion::sort_edges_into_bins() {
  min_x_ = min_y_ = kInfinity;
  max_x_ = max_y_ = -min_x_;
  std::vector<Interval> reaches;
  reaches.reserve(edges_.size());
  for (const Edge& e : edges_) {
    min_x_ = std::min(min_x_, e.min_x), max_x_ = std::max(max_x_, e.max_x);
    min_y_ = std::min(min_y_, e.min_y), max_y_ = std::max(max_y_, e.max_y);
    reaches.push_back({e.min_y, e.max_y});
  }
  bins_ = BinsAlongY(reaches);
}

bool GridRegion::touches(const Edge& e, const GridBox& box) noexcept {
  if (box.max_x < e.min_x || e.max_x < box.min_x || box.max_y < e.min_y || e.max_y < box.min_y) {
    return false;
  }
  const double most = line(e, e.nx > 0 ? box.max_x : box.min_x, e.ny > 0 ? box.max_y : box.min_y);
  const double least = line(e, e.nx > 0 ? box.min_x : box.max_x, e.ny > 0 ? box.min_y : box.max_y);
  return most >= -e.slack && least <= e.slack;
}

/// Separating axes of a segment and a triangle: the segment's normal, the normals of the triangle's
/// edges, and the boxes.
bool GridRegion::touches(const Edge& e, const GridPoint (&t)[3]) noexcept {
  if (!touches(e, box_of(t))) {
    return false;
  }
  int left = 0;
  int right = 0;
  for (int i = 0; i < 3; ++i) {
    const double value = line(e, t[i].x, t[i].y);
    left += value < -e.slack ? 1 : 0;
    right += value > e.slack ? 1 : 0;
    const GridPoint next = t[i == 2 ? 0 : i + 1];
    if (surely_right(t[i], next, e.ax, e.ay, e.slack_x, e.slack_y) &&
        surely_right(t[i], next, e.bx, e.by, e.slack_x, e.slack_y)) {
      return false;
    }
  }
  return left < 3 && right < 3;
}

template <typename Test>
bool GridRegion::any_edge(const GridBox& box, const Test& test) const noexcept {
  return bins_.any(box.min_y, box.max_y, [&](std::uint32_t i) { return test(edges_[i]); });
}

/// Even-odd rule along a ray to the east. Where no edge touches {p}, every sign below is certain,
/// so the answer is that of the exact polygon and is the same for all points of a box that no edge
/// touches: this is what makes meets(box) monotone.
GridRegion::Side GridRegion::side_of(GridPoint p) const noexcept {
  bool inside = false;
  for (const std::uint32_t i : bins_.at(p.y)) {
    const Edge& e = edges_[i];
    if ((e.ay <= p.y) == (e.by <= p.y) || p.x > e.max_x) {
      continue;
    }
    if (p.x >= e.min_x) {
      const double value = line(e, p.x, p.y);
      if (std::abs(value) <= e.slack) {
        return Side::kBorder;
      }
      if ((value > 0) == (e.by > e.ay)) {
        continue;  // p lies to the east of the edge
      }
    }
    inside = !inside;
  }
  return inside ? Side::kInside : Side::kOutside;
}

GridBox GridRegion::bounds() const noexcept {
  const auto bounded = [](double v) {
    return static_cast<std::int32_t>(std::clamp(v, double{INT32_MIN}, double{INT32_MAX}));
  };
  return {bounded(std::floor(min_x_) - 1.0), bounded(std::floor(min_y_) - 1.0),
          bounded(std::ceil(max_x_) + 1.0), bounded(std::ceil(max_y_) + 1.0)};
}

bool GridRegion::meets(const GridBox& box) const noexcept {
  if (box.max_x < min_x_ || max_x_ < box.min_x || box.max_y < min_y_ || max_y_ < box.min_y) {
    return false;
  }
  if (kind_ == Kind::kRectangle) {
    return true;
  }
  return any_edge(box, [&](const Edge& e) { return touches(e, box); }) ||
         (kind_ == Kind::kPolygon && side_of({box.min_x, box.min_y}) != Side::kOutside);
}

/// A box that no edge touches is on one side as a whole, and so is every box within it (side_of()).
bool GridRegion::contains(const GridBox& box) const noexcept {
  if (box.min_x < min_x_ || max_x_ < box.max_x || box.min_y < min_y_ || max_y_ < box.max_y) {
    return false;
  }
  if (kind_ == Kind::kRectangle) {
    return true;
  }
  return kind_ == Kind::kPolygon &&
         !any_edge(box, [&](const Edge& e) { return touches(e, box); }) &&
         side_of({box.min_x, box.min_y}) == Side::kInside;
}

/// Only the part of the rectangle inside of the triangle's box matters; there all products are of
/// the triangle's own size.
bool GridRegion::rectangle_meets(const GridPoint (&t)[3]) const noexcept {
  const GridBox box = box_of(t);
  const double low_x = std::max<double>(min_x_, box.min_x);
  const double low_y = std::max<double>(min_y_, box.min_y);
  const double high_x = std::min<double>(max_x_, box.max_x);
  const double high_y = std::min<double>(max_y_, box.max_y);
  for (int i = 0; i < 3; ++i) {
    const GridPoint a = t[i];
    const GridPoint b = t[i == 2 ? 0 : i + 1];
    // The corner of the rectangle that lies farthest to the left of a -> b.
    if (surely_right(a, b, b.y > a.y ? low_x : high_x, b.x > a.x ? high_y : low_y, 0, 0)) {
      return false;
    }
  }
  return true;
}

bool GridRegion::meets(GridPoint a, GridPoint b, GridPoint c) const noexcept {
  const GridPoint t[3] = {a, b, c};
  const GridBox box = box_of(t);
  if (!meets(box)) {
    return false;
  }
  if (kind_ == Kind::kRectangle) {
    return rectangle_meets(t);
  }
  return any_edge(box, [&](const Edge& e) { return touches(e, t); }) ||
         (kind_ == Kind::kPolygon && side_of(a) != Side::kOutside);
}

}  // namespace ptin
