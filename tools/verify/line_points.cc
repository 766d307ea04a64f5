// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/line_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ptin::tools {

namespace {

constexpr double kMostPoints = 256.0;
constexpr double kWider = 1e-7;

/// The weights of the corners at a point, where the triangle holds it; else false.
bool weights_at(const std::array<GridPoint, 3>& c, const LinePoint& p,
                std::array<double, 3>& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const GridPoint a = c[(i + 1) % 3], b = c[(i + 2) % 3];
    weights[i] = (static_cast<double>(b.x) - a.x) * (p.y - a.y) -
                 (static_cast<double>(b.y) - a.y) * (p.x - a.x);
    sum += weights[i];
  }
  return std::all_of(weights.begin(), weights.end(), [&](double w) { return w >= -kWider * sum; });
}

double height_of(const Tin& tin, TriangleId t, const HeightEncoding& heights,
                 const std::array<double, 3>& weights) {
  const auto corner = [&](std::size_t i) {
    return heights.height(tin.vertices[tin.triangles[t].v[i]].height);
  };
  const double base = corner(0);  // so that a flat triangle comes out exact
  return base + (weights[1] * (corner(1) - base) + weights[2] * (corner(2) - base)) /
                    (weights[0] + weights[1] + weights[2]);
}

}  // namespace

std::vector<LinePoint> points_along(const LineSamples& lines, const GridBox& box,
                                    const std::function<double(GridPoint)>& height_at) {
  std::vector<LinePoint> points;
  for (const LinePiece& piece : lines.pieces()) {
    if (piece.a.x > box.max_x) break;  // sorted
    if (!meets(united(box_of(piece.a), piece.b), box)) continue;
    const double low = height_at(piece.a), high = height_at(piece.b);
    const double dx = static_cast<double>(piece.b.x) - piece.a.x;
    const double dy = static_cast<double>(piece.b.y) - piece.a.y;
    const int steps = static_cast<int>(std::clamp(std::hypot(dx, dy), 4.0, kMostPoints));
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double x = piece.a.x + t * dx, y = piece.a.y + t * dy;
      if (x < box.min_x || x > box.max_x || y < box.min_y || y > box.max_y) continue;
      points.push_back({x, y, low + t * (high - low)});
    }
  }
  std::sort(points.begin(), points.end(),
            [](const LinePoint& a, const LinePoint& b) { return a.y < b.y; });
  return points;
}

std::vector<double> distances_from(const Tin& tin, const HeightEncoding& heights,
                                   const std::vector<LinePoint>& points) {
  std::vector<double> off(points.size(), std::numeric_limits<double>::infinity());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] == TriangleClass::kVoid) continue;
    const auto& v = tin.triangles[t].v;
    const std::array<GridPoint, 3> c{tin.position(v[0]), tin.position(v[1]), tin.position(v[2])};
    const double low = std::min({c[0].y, c[1].y, c[2].y}) - kWider;
    const double high = std::max({c[0].y, c[1].y, c[2].y}) + kWider;
    auto p = std::lower_bound(points.begin(), points.end(), low,
                              [](const LinePoint& q, double y) { return q.y < y; });
    for (; p != points.end() && p->y <= high; ++p) {
      std::array<double, 3> weights{};
      if (!weights_at(c, *p, weights)) continue;
      double& found = off[static_cast<std::size_t>(p - points.begin())];
      found = std::min(found, std::abs(height_of(tin, t, heights, weights) - p->height));
    }
  }
  return off;
}

}  // namespace ptin::tools
