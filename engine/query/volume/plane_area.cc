// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/plane_area.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// A bound that is computed with a few roundings, made one that certainly holds.
constexpr double kOutward = 1 + 1e-9;
constexpr double kLongestFacet = 2.0;  ///< Along y, degrees.

/// The node of a rule in barycentric coordinates, and its weight.
struct Node {
  double a, b, c, weight;
};

/// Radon's rule: exact for polynomials of degree five.
std::array<Node, 7> radon() {
  const double s = std::sqrt(15.0);
  const double low = (6 - s) / 21, high = (6 + s) / 21;
  const double of_low = (155 - s) / 1200, of_high = (155 + s) / 1200;
  return {{{1.0 / 3, 1.0 / 3, 1.0 / 3, 0.225},
           {low, low, 1 - 2 * low, of_low},
           {low, 1 - 2 * low, low, of_low},
           {1 - 2 * low, low, low, of_low},
           {high, high, 1 - 2 * high, of_high},
           {high, 1 - 2 * high, high, of_high},
           {1 - 2 * high, high, high, of_high}}};
}

/// The four triangles between the corners of a facet and the middles of its sides.
std::array<Facet, 4> quarters(const Facet& t) {
  Facet middle{t.area / 4, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    middle.y[i] = (t.y[(i + 1) % 3] + t.y[(i + 2) % 3]) / 2;
    middle.f[i] = (t.f[(i + 1) % 3] + t.f[(i + 2) % 3]) / 2;
  }
  std::array<Facet, 4> parts{middle, middle, middle, middle};
  for (std::size_t i = 0; i < 3; ++i) {
    parts[i].y[i] = t.y[i];
    parts[i].f[i] = t.f[i];
  }
  return parts;
}

}  // namespace

PlaneArea::PlaneArea(const AffineMap& map, const GroundScale& scale)
    : map_(map), scale_(scale), uniform_{map.step_x, map.step_y} {
  if (!scale_.per_map_unit) scale_.is_uniform = true;
  if (scale_.is_uniform && scale_.per_map_unit) {
    const MapPoint unit = scale_.per_map_unit({map.origin_x, map.origin_y});
    uniform_ = {map.step_x * unit.x, map.step_y * unit.y};
  }
}

double PlaneArea::integral(const Facet& t) const {
  if (scale_.is_uniform) {
    return t.area * (uniform_.x * uniform_.y) * ((t.f[0] + t.f[1] + t.f[2]) / 3);
  }
  const auto [low, high] = std::minmax_element(t.y.begin(), t.y.end());
  if ((*high - *low) * map_.step_y > kLongestFacet) {
    double sum = 0.0;
    for (const Facet& part : quarters(t)) sum += integral(part);
    return sum;
  }
  static const std::array<Node, 7> nodes = radon();
  double sum = 0.0;
  for (const Node& n : nodes) {
    const double y = n.a * t.y[0] + n.b * t.y[1] + n.c * t.y[2];
    sum += n.weight * density(y) * (n.a * t.f[0] + n.b * t.f[1] + n.c * t.f[2]);
  }
  return t.area * sum;
}

double PlaneArea::area(const Facet& t) const { return integral({t.area, t.y, {1, 1, 1}}); }

PositivePart PlaneArea::positive(const Facet& t) const {
  const int above = (t.f[0] > 0) + (t.f[1] > 0) + (t.f[2] > 0);
  if (above == 0) return {};
  const bool is_whole = std::min({t.f[0], t.f[1], t.f[2]}) >= 0;
  if (is_whole) return {integral(t), area(t)};
  // Corner 0 is the one that lies alone on its side, 1 and 2 the others; s and r are where f is 0
  // between 1 and 0 and between 2 and 0, as shares of the way from 1 and from 2.
  const bool has_one = above == 1;
  std::size_t i = 0;
  while ((t.f[i] > 0) != has_one) ++i;
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double r = t.f[j] / (t.f[j] - t.f[i]);
  const double s = t.f[k] / (t.f[k] - t.f[i]);
  const double y_r = t.y[j] + r * (t.y[i] - t.y[j]);
  const double y_s = t.y[k] + s * (t.y[i] - t.y[k]);
  if (has_one) {
    const double p = t.f[i] / (t.f[i] - t.f[j]), q = t.f[i] / (t.f[i] - t.f[k]);
    const Facet tip{t.area * p * q, {t.y[i], y_r, y_s}, {t.f[i], 0, 0}};
    return {integral(tip), area(tip)};
  }
  const Facet first{t.area * s, {t.y[j], t.y[k], y_s}, {t.f[j], t.f[k], 0}};
  const Facet second{t.area * r * (1 - s), {t.y[j], y_s, y_r}, {t.f[j], 0, 0}};
  return {integral(first) + integral(second), area(first) + area(second)};
}

/// Along a meridian units grow to the poles, and along a parallel to the equator.
MapPoint PlaneArea::largest_unit(double y0, double y1) const {
  const MapPoint a = unit_at(y0), b = unit_at(y1);
  MapPoint largest{std::max(a.x, b.x), std::max(a.y, b.y)};
  const double equator = -map_.origin_y / map_.step_y;
  if (!scale_.is_uniform && std::min(y0, y1) < equator && equator < std::max(y0, y1)) {
    largest.x = std::max(largest.x, unit_at(equator).x);
  }
  return largest;
}

double PlaneArea::length_at_most(MapPoint a, MapPoint b) const {
  const MapPoint unit = largest_unit(a.y, b.y);
  return kOutward * std::hypot((b.x - a.x) * unit.x, (b.y - a.y) * unit.y);
}

double PlaneArea::area_at_most(const GridBox& box) const {
  if (is_empty(box)) return 0.0;
  const MapPoint unit = largest_unit(box.min_y, box.max_y);
  return kOutward * (double{1} * box.max_x - box.min_x) * unit.x *
         (double{1} * box.max_y - box.min_y) * unit.y;
}

MapPoint PlaneArea::grid_reach(double length, const GridBox& box) const {
  // A unit along x is shortest at the end of the box that is nearest to a pole, one along y at the
  // other end or at the equator.
  const MapPoint a = unit_at(box.min_y), b = unit_at(box.max_y);
  const double equator =
      std::clamp(-map_.origin_y / map_.step_y, double(box.min_y), double(box.max_y));
  const double x = std::min(a.x, b.x), y = std::min({a.y, b.y, unit_at(equator).y});
  const auto reach = [&](double unit) { return unit > 0 ? kOutward * length / unit : kInfinity; };
  return {reach(x), reach(y)};
}

}  // namespace ptin
