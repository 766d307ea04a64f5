// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/direction.h"

namespace ptin {

WayIn way_into(const std::array<GridPoint, 3>& corners) noexcept {
  WayIn way;
  double longest = -1.0;
  for (int i = 0; i < 3; ++i) {
    const GridPoint a = corners[(i + 1) % 3], b = corners[(i + 2) % 3];
    const double dx = static_cast<double>(a.x) - b.x;
    const double dy = static_cast<double>(a.y) - b.y;
    if (dx * dx + dy * dy > longest) {
      longest = dx * dx + dy * dy;
      way.corner = i;
    }
  }
  const GridPoint p = corners[way.corner];
  const GridPoint next = corners[(way.corner + 1) % 3], previous = corners[(way.corner + 2) % 3];
  for (Direction d = 1; d <= kDirections; ++d) {
    if (orient_towards(p, next, p, d) > 0 && orient_towards(previous, p, p, d) > 0) {
      way.direction = d;
      break;
    }
  }
  return way;
}

}  // namespace ptin
