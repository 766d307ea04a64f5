// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/polygon_border.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/query/shape/clip.h"

namespace ptin {

namespace {

std::vector<std::vector<MapPoint>> rings_on_grid(const Polygon& polygon, const AffineMap& map) {
  std::vector<std::vector<MapPoint>> rings = polygon.rings;
  for (std::vector<MapPoint>& ring : rings) {
    for (MapPoint& p : ring) p = map.to_grid(p);
  }
  return rings;
}

MapPoint position_of(const ClippedCorner& c) { return {c[0], c[1]}; }

/// A place of the triangle with its value.
ClippedCorner valued(const std::array<ClippedCorner, 3>& triangle, MapPoint p) {
  const MapPoint o = position_of(triangle[0]), b = position_of(triangle[1]),
                 c = position_of(triangle[2]);
  const double whole = cross(o, b, c);
  const double of_b = cross(o, p, c) / whole, of_c = cross(o, b, p) / whole;
  const auto [low, high] = std::minmax({triangle[0][2], triangle[1][2], triangle[2][2]});
  const double value = triangle[0][2] + (of_b * (triangle[1][2] - triangle[0][2]) +
                                         of_c * (triangle[2][2] - triangle[0][2]));
  return {p.x, p.y, std::clamp(value, low, high)};
}

}  // namespace

PolygonBorder::PolygonBorder(const Polygon& polygon, const AffineMap& map)
    : sides_(rings_on_grid(polygon, map)) {}

void PolygonBorder::visit_shared(const std::array<ClippedCorner, 3>& triangle,
                                 std::vector<ClippedCorner>& ends) const {
  const auto [min_x, max_x] = std::minmax({triangle[0][0], triangle[1][0], triangle[2][0]});
  const auto [min_y, max_y] = std::minmax({triangle[0][1], triangle[1][1], triangle[2][1]});
  sides_.visit_near({min_x, min_y, max_x, max_y}, [&](const PolygonSides::Side& side) {
    double from = 0.0, to = 1.0;  // shares of the side, from its low end
    for (std::size_t i = 0; i < 3; ++i) {
      const MapPoint o = position_of(triangle[i]), d = position_of(triangle[(i + 1) % 3]);
      const double slack = sides_.slack() * std::hypot(d.x - o.x, d.y - o.y);
      const double low = cross(o, d, side.low), high = cross(o, d, side.high);
      if (low < -slack && high < -slack) return;
      if (low >= -slack && high >= -slack) continue;
      const double share = low / (low - high);
      (low < high ? from : to) = low < high ? std::max(from, share) : std::min(to, share);
    }
    if (from > to) {
      // A side that passes a corner within rounding.
      const double length = std::hypot(side.high.x - side.low.x, side.high.y - side.low.y);
      if ((from - to) * length > sides_.slack()) return;
      to = from;
    }
    for (const double share : {from, to}) {
      const MapPoint at = share == 1.0 ? side.high
                                       : MapPoint{side.low.x + share * (side.high.x - side.low.x),
                                                  side.low.y + share * (side.high.y - side.low.y)};
      ends.push_back(valued(triangle, at));
    }
  });
}

}  // namespace ptin
