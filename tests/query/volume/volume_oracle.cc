// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/volume/volume_oracle.h"

#include <algorithm>
#include <functional>
#include <span>
#include <utility>

namespace ptin::reference {

namespace {

/// The convex hull, counter-clockwise (Andrew, 1979).
RationalPolygon hull(RationalPolygon points) {
  const auto before = [](const RationalPoint& a, const RationalPoint& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  };
  std::sort(points.begin(), points.end(), before);
  RationalPolygon ring;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t begin = ring.size();
    for (const RationalPoint& p : points) {
      while (ring.size() >= begin + 2 && cross(ring[ring.size() - 2], ring.back(), p) <= 0) {
        ring.pop_back();
      }
      ring.push_back(p);
    }
    if (!ring.empty()) ring.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return ring;
}

bool holds(const RationalPolygon& polygon, const RationalPoint& p) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (cross(polygon[i], polygon[(i + 1) % polygon.size()], p) < 0) return false;
  }
  return true;
}

RationalPolygon shared(const RationalPolygon& a, const RationalPolygon& b) {
  RationalPolygon points;
  std::copy_if(a.begin(), a.end(), std::back_inserter(points),
               [&](const RationalPoint& p) { return holds(b, p); });
  std::copy_if(b.begin(), b.end(), std::back_inserter(points),
               [&](const RationalPoint& p) { return holds(a, p); });
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const RationalPoint &p = a[i], &q = a[(i + 1) % a.size()];
      const RationalPoint &r = b[j], &s = b[(j + 1) % b.size()];
      const Rational at_r = cross(p, q, r), at_s = cross(p, q, s);
      if (at_r * at_s >= 0 || cross(r, s, p) * cross(r, s, q) >= 0) continue;
      points.push_back(along(r, s, at_r / (at_r - at_s)));
    }
  }
  return hull(std::move(points));
}

Rational area_of(const RationalPolygon& polygon) {
  Rational twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += cross(polygon[0], polygon[i], polygon[i + 1]);
  }
  return twice / 2;
}

using Height = std::function<Rational(const RationalPoint&)>;

/// The integral of max(f, 0) over a convex polygon on which f is linear.
Rational positive_volume(const RationalPolygon& polygon, const Height& f) {
  RationalPolygon above;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const RationalPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Rational at_p = f(p), at_q = f(q);
    if (at_p >= 0) above.push_back(p);
    if (at_p * at_q < 0) above.push_back(along(p, q, at_p / (at_p - at_q)));
  }
  above = hull(std::move(above));
  Rational sum = 0;
  for (std::size_t i = 1; i + 1 < above.size(); ++i) {
    sum +=
        cross(above[0], above[i], above[i + 1]) / 6 * (f(above[0]) + f(above[i]) + f(above[i + 1]));
  }
  return sum;
}

/// Triangles whose signed sum is the polygon, the first ring less the others.
struct SignedTriangle {
  RationalPolygon corners;
  int sign;
};
std::vector<SignedTriangle> signed_triangles(const std::vector<std::vector<MapPoint>>& rings) {
  std::vector<SignedTriangle> all;
  for (const std::vector<MapPoint>& ring : rings) {
    RationalPolygon points;
    for (const MapPoint p : ring) points.push_back({Rational(p.x), Rational(p.y)});
    const int outer = (&ring == &rings.front() ? 1 : -1) * (area_of(points) > 0 ? 1 : -1);
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const bool is_left = cross(points[0], points[i], points[i + 1]) > 0;
      all.push_back({hull({points[0], points[i], points[i + 1]}), is_left ? outer : -outer});
    }
  }
  return all;
}

void add(const RationalPolygon& piece, const Height& f, bool is_surface, int sign,
         RationalVolume& volume) {
  if (piece.size() < 3) return;
  (is_surface ? volume.surface_area : volume.void_area) += sign * area_of(piece);
  if (!is_surface) return;
  volume.cut += sign * positive_volume(piece, f);
  volume.fill += sign * positive_volume(piece, [&](const RationalPoint& p) { return -f(p); });
}

void add_in_region(const RationalPolygon& piece, const Height& f, bool is_surface,
                   const std::vector<SignedTriangle>& region, bool is_everywhere,
                   RationalVolume& volume) {
  if (piece.size() < 3) return;
  if (is_everywhere) add(piece, f, is_surface, 1, volume);
  for (const SignedTriangle& t : region) {
    add(shared(piece, t.corners), f, is_surface, t.sign, volume);
  }
}

/// Whether boxes share nothing, for sure: doubles are good enough to pass over most pairs.
bool are_apart(const RationalTriangle& a, const RationalTriangle& b) {
  const auto apart = [&](int coordinate) {
    return a.high[coordinate] < b.low[coordinate] - 1e-6 ||
           b.high[coordinate] < a.low[coordinate] - 1e-6;
  };
  return apart(0) || apart(1);
}

RationalPolygon polygon_of(const RationalTriangle& t) {
  return {t.corners.begin(), t.corners.end()};
}

}  // namespace

Rational RationalTriangle::at(const RationalPoint& p) const {
  const Rational whole = cross(corners[0], corners[1], corners[2]);
  return (cross(p, corners[1], corners[2]) * heights[0] +
          cross(corners[0], p, corners[2]) * heights[1] +
          cross(corners[0], corners[1], p) * heights[2]) /
         whole;
}

std::vector<RationalTriangle> rational_triangles(const Tin& tin, const StoreFacts& facts) {
  std::vector<RationalTriangle> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) continue;
    RationalTriangle triangle;
    triangle.is_surface = tin.classes[t] == TriangleClass::kSurface;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId v = tin.triangles[t].v[i];
      const GridPoint p = tin.position(v);
      triangle.corners[i] = {Rational(facts.map.origin_x) + Rational(facts.map.step_x) * p.x,
                             Rational(facts.map.origin_y) + Rational(facts.map.step_y) * p.y};
      const double at[] = {triangle.corners[i].x.convert_to<double>(),
                           triangle.corners[i].y.convert_to<double>()};
      for (int k = 0; k < 2; ++k) {
        triangle.low[k] = i == 0 ? at[k] : std::min(triangle.low[k], at[k]);
        triangle.high[k] = i == 0 ? at[k] : std::max(triangle.high[k], at[k]);
      }
      if (tin.has_height[v] == 0) continue;
      triangle.heights[i] =
          Rational(facts.heights.offset) +
          Rational(facts.heights.step) * Rational(facts.heights.code(tin.vertices[v].height));
    }
    all.push_back(triangle);
  }
  return all;
}

RationalVolume volume_above(const std::vector<RationalTriangle>& triangles, double level,
                            const std::vector<std::vector<MapPoint>>& rings) {
  RationalVolume volume;
  const std::vector<SignedTriangle> region = signed_triangles(rings);
  for (const RationalTriangle& t : triangles) {
    const Height f = [&](const RationalPoint& p) { return Rational(t.at(p) - Rational(level)); };
    add_in_region(polygon_of(t), f, t.is_surface, region, rings.empty(), volume);
  }
  return volume;
}

RationalVolume volume_between(const std::vector<RationalTriangle>& here,
                              const std::vector<RationalTriangle>& there,
                              const std::vector<std::vector<MapPoint>>& rings) {
  RationalVolume volume;
  const std::vector<SignedTriangle> region = signed_triangles(rings);
  for (const RationalTriangle& a : here) {
    for (const RationalTriangle& b : there) {
      if (are_apart(a, b)) continue;
      const Height f = [&](const RationalPoint& p) { return Rational(a.at(p) - b.at(p)); };
      add_in_region(shared(polygon_of(a), polygon_of(b)), f, a.is_surface && b.is_surface, region,
                    rings.empty(), volume);
    }
  }
  return volume;
}

}  // namespace ptin::reference
