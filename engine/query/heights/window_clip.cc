// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/window_clip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/query/walk/spot.h"

namespace ptin {

namespace {

/// A corner of the window as a spot. A corner beyond the domain's box is moved to two grid units
/// beyond it.
Spot spot_of_clamped(double x, double y, const GridBox& b) {
  const auto spot = [](double v, std::int32_t low, std::int32_t high) {
    return std::llround(std::ldexp(std::clamp(v, low - 2.0, high + 2.0), kSpotBits));
  };
  return {spot(x, b.min_x, b.max_x), spot(y, b.min_y, b.max_y)};
}

/// Whether a triangle and a rectangle share a point.
/// @param corners  Of the rectangle, counter-clockwise from the south-west.
bool meets(const Tin& tin, const Triangle& t, const std::array<Spot, 4>& corners) {
  const Spot low = corners[0], high = corners[2];
  GridBox box = box_of(tin.position(t.v[0]));
  box = united(united(box, box_of(tin.position(t.v[1]))), box_of(tin.position(t.v[2])));
  const Spot box_low = spot_of(GridPoint{box.min_x, box.min_y});
  const Spot box_high = spot_of(GridPoint{box.max_x, box.max_y});
  if (high.x < box_low.x || high.y < box_low.y || box_high.x < low.x || box_high.y < low.y) {
    return false;
  }
  for (int i = 0; i < 3; ++i) {  // apart when one side has the whole rectangle beyond it
    const GridPoint from = tin.position(t.v[i]);
    const GridPoint to = tin.position(t.v[next_corner(i)]);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](Spot s) { return side(from, to, s) < 0; })) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<ClippedCorner> clipped(std::vector<ClippedCorner> polygon, const GridWindow& window) {
  const std::array<std::array<double, 4>, 4> sides = {{{0, window.min_x, 1, 0},
                                                       {0, window.max_x, -1, 0},
                                                       {1, window.min_y, 1, 0},
                                                       {1, window.max_y, -1, 0}}};
  for (const auto& side : sides) {
    const auto axis = static_cast<std::size_t>(side[0]);
    const auto inside = [&](const ClippedCorner& c) { return (c[axis] - side[1]) * side[2] >= 0; };
    std::vector<ClippedCorner> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const ClippedCorner& a = polygon[i];
      const ClippedCorner& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      if (inside(a)) {
        kept.push_back(a);
      }
      if (inside(a) != inside(b)) {
        const double t = (side[1] - a[axis]) / (b[axis] - a[axis]);
        ClippedCorner cut{};
        for (std::size_t k = 0; k < 3; ++k) {
          cut[k] = a[k] + t * (b[k] - a[k]);
        }
        cut[axis] = side[1];
        kept.push_back(cut);
      }
    }
    polygon = std::move(kept);
  }
  return polygon;
}

bool meets_domain(const GridWindow& window, const Tin& t0, const GridBox& bounds) {
  const Spot low = spot_of_clamped(window.min_x, window.min_y, bounds);
  const Spot high = spot_of_clamped(window.max_x, window.max_y, bounds);
  const std::array<Spot, 4> corners{low, Spot{high.x, low.y}, high, Spot{low.x, high.y}};
  return std::any_of(t0.triangles.begin(), t0.triangles.end(),
                     [&](const Triangle& t) { return meets(t0, t, corners); });
}

}  // namespace ptin
