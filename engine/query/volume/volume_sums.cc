// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/query/shape/clip.h"

namespace ptin {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// A bound for the roundings of the formulas below, each of which has fewer operations.
constexpr double kRoundings = 16 * kEpsilon;
/// How good integrals are in degrees (plane_area.h), as a share.
constexpr double kQuadrature = 1e-11;

/// Width plus height of the box around points.
double half_perimeter_of(std::span<const MapPoint> points) {
  MapPoint low = points.front(), high = low;
  for (const MapPoint p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return (high.x - low.x) + (high.y - low.y);
}

}  // namespace

double LinearHeight::at(MapPoint p) const {
  const MapPoint o = corners[0];
  const double px = p.x - o.x, py = p.y - o.y;
  const double bx = corners[1].x - o.x, by = corners[1].y - o.y;
  const double cx = corners[2].x - o.x, cy = corners[2].y - o.y;
  const double whole = bx * cy - by * cx;
  const double of_b = (px * cy - py * cx) / whole;
  const double of_c = (bx * py - by * px) / whole;
  const double height =
      heights[0] + (of_b * (heights[1] - heights[0]) + of_c * (heights[2] - heights[0]));
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  return std::clamp(height, *low, *high);
}

double LinearHeight::noise(double shift) const {
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double across = half_perimeter_of(corners);
  const double thinness =
      across * (kRoundings * across + shift) / std::abs(cross(corners[0], corners[1], corners[2]));
  return std::min(thinness, 1.0) * (*high - *low) +
         kRoundings * std::max(std::abs(*low), std::abs(*high));
}

VolumeSums::VolumeSums(double most_area, double most_height)
    : cut_area(most_area),
      fill_area(most_area),
      surface_area(most_area),
      void_area(most_area),
      area_rounding(most_area) {
  const FixedSum volume(most_area * most_height);
  for (FixedSum* sum : {&cut, &fill, &least_cut, &most_cut, &least_fill, &most_fill, &slack,
                        &void_cut, &void_fill, &rounding}) {
    *sum = volume;
  }
}

void VolumeSums::add(const VolumeSums& o) {
  cut.add(o.cut);
  fill.add(o.fill);
  cut_area.add(o.cut_area);
  fill_area.add(o.fill_area);
  surface_area.add(o.surface_area);
  void_area.add(o.void_area);
  least_cut.add(o.least_cut);
  most_cut.add(o.most_cut);
  least_fill.add(o.least_fill);
  most_fill.add(o.most_fill);
  slack.add(o.slack);
  void_cut.add(o.void_cut);
  void_fill.add(o.void_fill);
  rounding.add(o.rounding);
  area_rounding.add(o.area_rounding);
}

void VolumeSums::add_surface(const PlaneArea& plane, const ConvexPiece& piece,
                             std::span<const double> f, const PieceDifference& how) {
  const std::span<const MapPoint> at = piece.corners();
  double most = 0.0;
  for (const double value : f) most = std::max(most, std::abs(value));
  const double of_heights = how.noise + (plane.is_uniform() ? kRoundings : kQuadrature) * most;
  for (std::size_t i = 1; i + 1 < at.size(); ++i) {
    const Facet t{piece.fan_area(i), {at[0].y, at[i].y, at[i + 1].y}, {f[0], f[i], f[i + 1]}};
    if (t.area == 0) continue;
    const double area = plane.area(t);
    surface_area.add(area);
    rounding.add(area * of_heights);
    slack.add(area * how.deviation);
    add_facet(plane, t, how.deviation);
  }
  if (how.shift > 0) {
    const double strip = plane.strip_area(half_perimeter_of(at), how.shift, at[0].y);
    rounding.add(strip * most);
    area_rounding.add(strip);
  }
}

void VolumeSums::add_facet(const PlaneArea& plane, const Facet& t, double deviation) {
  const auto above = [&](double sign, double raised) {
    Facet facet = t;
    for (double& f : facet.f) f = sign * f + raised;
    return plane.positive(facet);
  };
  const PositivePart over = above(1, 0), under = above(-1, 0);
  cut.add(over.volume);
  cut_area.add(over.area);
  fill.add(under.volume);
  fill_area.add(under.area);
  const bool is_exact = deviation == 0;
  least_cut.add(is_exact ? over.volume : above(1, -deviation).volume);
  most_cut.add(is_exact ? over.volume : above(1, deviation).volume);
  least_fill.add(is_exact ? under.volume : above(-1, -deviation).volume);
  most_fill.add(is_exact ? under.volume : above(-1, deviation).volume);
}

void VolumeSums::add_void(const PlaneArea& plane, const ConvexPiece& piece,
                          const Interval& possible) {
  const std::span<const MapPoint> at = piece.corners();
  for (std::size_t i = 1; i + 1 < at.size(); ++i) {
    const double area = plane.area({piece.fan_area(i), {at[0].y, at[i].y, at[i + 1].y}, {1, 1, 1}});
    void_area.add(area);
    if (is_empty(possible)) continue;
    void_cut.add(area * std::max(possible.hi, 0.0));
    void_fill.add(area * std::max(-possible.lo, 0.0));
  }
}

}  // namespace ptin
