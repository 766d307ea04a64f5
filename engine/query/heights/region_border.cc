// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/region_border.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include <boost/multiprecision/cpp_int.hpp>

#include "engine/geometry/affine_rounding.h"
#include "engine/query/shape/clip.h"

namespace ptin {

namespace {

/// How far beyond the domain a side of a window is taken as it is: what lies there meets no triangle,
/// and rounding stays that of the domain's own coordinates.
constexpr double kBeyond = 2.0;

std::vector<std::vector<MapPoint>> rings_on_grid(const Region& region, const AffineMap& map,
                                                 const GridBox& bounds) {
  if (const auto* window = std::get_if<Window>(&region)) {
    const GridWindow w = on_grid(*window, map);
    const auto near = [](double v, std::int32_t low, std::int32_t high) {
      return std::clamp(v, low - kBeyond, high + kBeyond);
    };
    const double min_x = near(w.min_x, bounds.min_x, bounds.max_x);
    const double max_x = near(w.max_x, bounds.min_x, bounds.max_x);
    const double min_y = near(w.min_y, bounds.min_y, bounds.max_y);
    const double max_y = near(w.max_y, bounds.min_y, bounds.max_y);
    return {std::vector<MapPoint>{{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}}};
  }
  std::vector<std::vector<MapPoint>> rings = std::get<Polygon>(region).rings;
  for (std::vector<MapPoint>& ring : rings) {
    for (MapPoint& p : ring) {
      p = {snapped_to_grid(p.x, map.origin_x, map.step_x),
           snapped_to_grid(p.y, map.origin_y, map.step_y)};
    }
  }
  return rings;
}

MapPoint position_of(const ValuedPlace& c) { return {c[0], c[1]}; }

using Rational = boost::multiprecision::cpp_rational;

Rational exact_cross(MapPoint o, MapPoint a, MapPoint b) {
  const Rational x = o.x, y = o.y;
  return (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x);
}

/// A place of the triangle with its value, which is exact but for one rounding.
ValuedPlace valued(const std::array<ValuedPlace, 3>& triangle, MapPoint p) {
  const MapPoint o = position_of(triangle[0]), b = position_of(triangle[1]),
                 c = position_of(triangle[2]);
  const auto [low, high] = std::minmax({triangle[0][2], triangle[1][2], triangle[2][2]});
  const Rational whole = exact_cross(o, b, c), value = triangle[0][2];
  if (whole == 0) return {p.x, p.y, low};  // in a damaged file
  const Rational rise = exact_cross(o, p, c) * (triangle[1][2] - value) +
                        exact_cross(o, b, p) * (triangle[2][2] - value);
  return {p.x, p.y, std::clamp(static_cast<double>(value + rise / whole), low, high)};
}

/// Where an edge crosses a side, exact but for one rounding: the same in both triangles at the edge, and
/// an end of the edge that lies on the side is met as it is.
ValuedPlace crossing(const ValuedPlace& a, const ValuedPlace& b, const PolygonSides::Side& s) {
  const Rational from = exact_cross(s.low, s.high, position_of(a));
  const Rational across = from - exact_cross(s.low, s.high, position_of(b));
  Rational share = 0;
  if (across != 0) share = from / across;
  if (share <= 0) return a;  // a side that is as near as rounding may pass the edge's ends
  if (share >= 1) return b;
  ValuedPlace place{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Rational begin = a[k];
    place[k] = static_cast<double>(begin + share * (b[k] - begin));
  }
  return place;
}

}  // namespace

RegionBorder::RegionBorder(const Region& region, const AffineMap& map, const GridBox& bounds)
    : RegionBorder(rings_on_grid(region, map, bounds)) {}

RegionBorder::RegionBorder(const std::vector<std::vector<MapPoint>>& rings) : sides_(rings) {
  // Sides that are shorter than rounding are none: the grid decides, not the numbers of the map.
  const MapPoint place = rings.front().front();
  const auto is_there = [&](MapPoint p) { return p.x == place.x && p.y == place.y; };
  if (std::all_of(rings.front().begin(), rings.front().end(), is_there)) {
    place_ = PolygonSides::Side{place, place};
  }
}

void RegionBorder::visit_shared(const std::array<ValuedPlace, 3>& triangle,
                                std::vector<ValuedPlace>& ends) const {
  const auto [min_x, max_x] = std::minmax({triangle[0][0], triangle[1][0], triangle[2][0]});
  const auto [min_y, max_y] = std::minmax({triangle[0][1], triangle[1][1], triangle[2][1]});
  sides_.visit_near({min_x, min_y, max_x, max_y},
                    [&](const PolygonSides::Side& side) { add_shared(triangle, side, ends); });
  if (place_) add_shared(triangle, *place_, ends);
}

void RegionBorder::add_shared(const std::array<ValuedPlace, 3>& triangle,
                              const PolygonSides::Side& side,
                              std::vector<ValuedPlace>& ends) const {
  // Shares of the side, from its low end, and the edges at which they end; 3: the side's own end.
  Rational from = 0, to = 1;
  std::size_t from_edge = 3, to_edge = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const MapPoint o = position_of(triangle[i]), d = position_of(triangle[(i + 1) % 3]);
    const double slack = sides_.slack() * std::hypot(d.x - o.x, d.y - o.y);
    const double low = cross(o, d, side.low), high = cross(o, d, side.high);
    if (low < -slack && high < -slack) return;
    if (low >= -slack && high >= -slack) continue;
    const Rational begin = exact_cross(o, d, side.low);
    const Rational across = begin - exact_cross(o, d, side.high);
    if (across == 0) continue;
    const Rational share = begin / across;
    if (across < 0 && share > from) {
      from = share;
      from_edge = i;
    } else if (across > 0 && share < to) {
      to = share;
      to_edge = i;
    }
  }
  if (from > to) {
    // A side that passes a corner within rounding.
    const double length = std::hypot(side.high.x - side.low.x, side.high.y - side.low.y);
    if (static_cast<double>(from - to) * length > sides_.slack()) return;
  }
  const auto end = [&](std::size_t edge, MapPoint own) {
    return edge == 3 ? valued(triangle, own)
                     : crossing(triangle[edge], triangle[(edge + 1) % 3], side);
  };
  ends.push_back(end(from_edge, side.low));
  ends.push_back(end(to_edge, side.high));
}

}  // namespace ptin
