// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/located_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/geometry/infinity.h"

namespace ptin {
namespace {

bool is_level(const std::array<LocatedPoint::Corner, 3>& triangle) noexcept {
  return triangle[0].height == triangle[1].height && triangle[1].height == triangle[2].height;
}

}  // namespace

void begin_with_least(std::array<LocatedPoint::Corner, 3>& triangle) {
  const auto least =
      std::min_element(triangle.begin(), triangle.end(),
                       [](const LocatedPoint::Corner& a, const LocatedPoint::Corner& b) {
                         return key_of(a.position) < key_of(b.position);
                       });
  std::rotate(triangle.begin(), least, triangle.end());
}

LocatedPoint located_at(const Tin& tin, const HeightEncoding& heights, Spot spot,
                        const Place& place) {
  LocatedPoint point;
  if (place.lies == Lies::kOutside) {
    return point;
  }
  const TriangleId t = answering_triangle(tin, place);
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    point.triangle[i].position = tin.position(v);
    if (tin.has_height[v] != 0) {
      point.triangle[i].height = heights.height(tin.vertices[v].height);
    }
  }
  point.state =
      tin.classes[t] == TriangleClass::kSurface ? PointState::kSurface : PointState::kVoid;
  if (point.state == PointState::kSurface) {
    const double code = code_at(tin, heights, footing_of(tin, spot, place));
    point.height = heights.height_of_code(code);
  }
  begin_with_least(point.triangle);
  return point;
}

SurfaceBounds bounds_at(const SurfaceBounds& of_triangle, const Detail& detail) {
  if (!detail.is_asked()) {
    return {0.0, {-kInfinity, kInfinity}};
  }
  return {std::min(of_triangle.deviation, detail.certificate().deviation), of_triangle.heights};
}

void set_interval(const SurfaceBounds& bounds, bool is_full, const StoreFacts& facts,
                  LocatedPoint& point) {
  const double deviation = std::max(bounds.deviation, facts.base_deviation);
  // A triangle of another level in the same plane rounds the height of a point its own way, but for
  // one that is level: the height of its corners.
  if (deviation == 0 && (is_full || is_level(point.triangle))) {
    point.height_min = point.height_max = point.height;
    return;
  }
  const double rounding = 16 * std::numeric_limits<double>::epsilon() *
                          (std::abs(point.height) + std::abs(facts.heights.offset) + deviation);
  // The heights below the triangle are stored ones; the source's may be off by the base (rounding,
  // --max-error).
  const double lowest = std::max(facts.heights.height_of_code(bounds.heights.lo), facts.min_height);
  const double highest =
      std::min(facts.heights.height_of_code(bounds.heights.hi), facts.max_height);
  point.height_min = std::max(point.height - deviation - rounding, lowest - facts.base_deviation);
  point.height_max = std::min(point.height + deviation + rounding, highest + facts.base_deviation);
}

}  // namespace ptin
