// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/polygon_sides.h"

#include <limits>
#include <tuple>
#include <utility>

#include "engine/query/shape/clip.h"

namespace ptin {

PolygonSides::PolygonSides(std::span<const std::vector<MapPoint>> rings) {
  double farthest = 0.0;
  for (const std::vector<MapPoint>& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      MapPoint a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      farthest = std::max({farthest, std::abs(a.x), std::abs(a.y)});
      if (a == b) continue;
      if (std::tie(b.x, b.y) < std::tie(a.x, a.y)) std::swap(a, b);
      sides_.push_back({a, b});
    }
  }
  slack_ = 8 * std::numeric_limits<double>::epsilon() * farthest;
  std::vector<Interval> reaches;
  reaches.reserve(sides_.size());
  for (const Side& s : sides_) {
    const auto [low, high] = std::minmax(s.low.y, s.high.y);
    reaches.push_back({low, high});
  }
  bins_ = BinsAlongY(reaches);
}

bool PolygonSides::surround(MapPoint p) const {
  bool is_odd = false;
  for (const std::uint32_t i : bins_.at(p.y)) {
    const Side& s = sides_[i];
    if ((s.low.y <= p.y) == (s.high.y <= p.y)) continue;
    // The side crosses the line to the right of the place where it has the place on its left, going
    // up.
    if ((cross(s.low, s.high, p) > 0) == (s.high.y > s.low.y)) is_odd = !is_odd;
  }
  return is_odd;
}

}  // namespace ptin
