// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/lone_points.h"

#include <cstdint>
#include <vector>

#include "engine/geometry/orient.h"

namespace ptin::tools {

namespace {

__extension__ using Wide = __int128;

struct Offset {
  std::int64_t x, y;
  [[nodiscard]] std::int64_t square() const { return x * x + y * y; }
};

std::int64_t turn(const Offset& a, const Offset& b) { return a.x * b.y - a.y * b.x; }

/// True when `s` lies in the circle through the origin, a and b, which turn to the left.
bool is_in_circle(const Offset& a, const Offset& b, const Offset& s) {
  return Wide{a.square()} * turn(b, s) - Wide{b.square()} * turn(a, s) +
             Wide{s.square()} * turn(a, b) <
         0;
}

}  // namespace

bool is_lone_point(GridPoint p, std::span<const SourceSample> around,
                   const std::function<bool(GridPoint, GridPoint)>& is_too_long) {
  std::vector<Offset> all, near;
  for (const SourceSample& s : around) {
    const GridPoint q{s.x, s.y};
    if (q == p) continue;
    all.push_back({std::int64_t{q.x} - p.x, std::int64_t{q.y} - p.y});
    if (!is_too_long(p, q)) near.push_back(all.back());
  }
  const auto place = [&](const Offset& o) {
    return GridPoint{static_cast<std::int32_t>(p.x + o.x), static_cast<std::int32_t>(p.y + o.y)};
  };
  for (const Offset& a : near) {
    for (const Offset& b : near) {
      if (turn(a, b) <= 0 || is_too_long(place(a), place(b))) continue;
      bool is_empty = true;
      for (const Offset& s : all) is_empty = is_empty && !is_in_circle(a, b, s);
      if (is_empty) return false;
    }
  }
  return true;
}

}  // namespace ptin::tools
