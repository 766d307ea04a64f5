// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/surface_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ptin::tools {

namespace {

constexpr double kMostPoints = 256.0;

/// The weights of the corners at a point, where the triangle holds it; else false.
bool weights_at(const std::array<GridPoint, 3>& c, const SurfacePoint& p, double wider,
                std::array<double, 3>& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const GridPoint a = c[(i + 1) % 3], b = c[(i + 2) % 3];
    weights[i] = (static_cast<double>(b.x) - a.x) * (p.y - a.y) -
                 (static_cast<double>(b.y) - a.y) * (p.x - a.x);
    sum += weights[i];
  }
  return std::all_of(weights.begin(), weights.end(), [&](double w) { return w >= -wider * sum; });
}

}  // namespace

std::vector<SurfacePoint> points_along(const LineSamples& lines, const GridBox& box,
                                       const std::function<double(GridPoint)>& height_at) {
  std::vector<SurfacePoint> points;
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
            [](const SurfacePoint& a, const SurfacePoint& b) { return a.y < b.y; });
  return points;
}

double height_in(const Tin& tin, TriangleId t, const HeightEncoding& heights,
                 const std::array<double, 3>& weights) {
  const auto corner = [&](std::size_t i) {
    return heights.height(tin.vertices[tin.triangles[t].v[i]].height);
  };
  // Relative to the first corner, so that a vertex and a flat triangle come out exact.
  const double base = corner(0);
  return base + (weights[1] * (corner(1) - base) + weights[2] * (corner(2) - base)) /
                    (weights[0] + weights[1] + weights[2]);
}

std::vector<double> heights_at(const Tin& tin, const HeightEncoding& heights,
                               const std::vector<SurfacePoint>& points, double wider) {
  std::vector<double> found(points.size(), std::numeric_limits<double>::quiet_NaN());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] == TriangleClass::kVoid) continue;
    const auto& v = tin.triangles[t].v;
    const std::array<GridPoint, 3> c{tin.position(v[0]), tin.position(v[1]), tin.position(v[2])};
    const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
    // A weight of -wider of the whole lies as much of the triangle's height beyond an edge.
    const double beyond = wider * (static_cast<double>(high) - low);
    auto p = std::lower_bound(points.begin(), points.end(), low - beyond,
                              [](const SurfacePoint& q, double y) { return q.y < y; });
    for (; p != points.end() && p->y <= high + beyond; ++p) {
      std::array<double, 3> weights{};
      if (!weights_at(c, *p, wider, weights)) continue;
      double& nearest = found[static_cast<std::size_t>(p - points.begin())];
      const double height = height_in(tin, t, heights, weights);
      const bool is_nearer = std::abs(height - p->height) < std::abs(nearest - p->height);
      if (std::isnan(nearest) || is_nearer) nearest = height;
    }
  }
  return found;
}

}  // namespace ptin::tools
