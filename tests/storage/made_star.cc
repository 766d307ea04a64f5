// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/storage/made_star.h"

#include <algorithm>
#include <numeric>

#include "engine/geometry/interval.h"
#include "storage/descriptor.h"

namespace ptin::test {

namespace {

/// An offset, turned to the left a number of times.
GridPoint turned(GridPoint d, int quarters) {
  for (; quarters > 0; --quarters) {
    d = {-d.y, d.x};
  }
  return d;
}

/// Directions of different angle up to `longest` in x and y, ascending from that of (1, 0).
std::vector<GridPoint> directions_within(std::int32_t longest) {
  std::vector<GridPoint> found;
  for (std::int32_t y = -longest; y <= longest; ++y) {
    for (std::int32_t x = -longest; x <= longest; ++x) {
      if (std::gcd(x, y) == 1) {
        found.push_back({x, y});
      }
    }
  }
  const auto is_lower = [](GridPoint d) { return d.y < 0 || (d.y == 0 && d.x < 0); };
  std::sort(found.begin(), found.end(), [&](GridPoint a, GridPoint b) {
    return is_lower(a) != is_lower(b) ? is_lower(b) : a.x * b.y - a.y * b.x > 0;
  });
  return found;
}

/// Enough directions for a ring, also of a vertex near the border.
const std::vector<GridPoint>& directions_for(std::size_t degree) {
  static const std::vector<GridPoint> few = directions_within(2);
  static const std::vector<GridPoint> many = directions_within(20);
  return degree < 10 ? few : many;
}

/// How often an offset fits between u and the end of the box.
std::int32_t room(GridPoint u, GridPoint d, const GridBox& box) {
  const auto along = [](std::int32_t at, std::int32_t step, std::int32_t low, std::int32_t high) {
    return step == 0 ? INT32_MAX : (step > 0 ? high - at : at - low) / std::abs(step);
  };
  return std::min(along(u.x, d.x, box.min_x, box.max_x), along(u.y, d.y, box.min_y, box.max_y));
}

}  // namespace

std::vector<GridPoint> made_ring(GridPoint u, const GridBox& box, std::size_t degree,
                                 std::int32_t reach, std::mt19937_64& random) {
  const bool sides[] = {u.y == box.min_y, u.x == box.max_x, u.y == box.max_y, u.x == box.min_x};
  const auto* side = std::find(std::begin(sides), std::end(sides), true);
  const bool is_open = side != std::end(sides);
  const int quarters = static_cast<int>(is_open ? side - std::begin(sides) : random() % 4);
  // Three corners with which all angles are below a half turn, and others between them.
  const std::vector<GridPoint> least = is_open ? std::vector<GridPoint>{{1, 0}, {0, 1}, {-1, 0}}
                                               : std::vector<GridPoint>{{1, 0}, {-1, 1}, {-1, -1}};
  const std::vector<GridPoint>& directions = directions_for(degree);
  std::vector<GridPoint> others;
  for (const GridPoint d : directions) {
    if (std::find(least.begin(), least.end(), d) == least.end() &&
        room(u, turned(d, quarters), box) > 0) {
      others.push_back(d);
    }
  }
  std::vector<GridPoint> chosen = least;
  std::sample(others.begin(), others.end(), std::back_inserter(chosen), degree - least.size(),
              random);
  std::vector<GridPoint> ring;
  for (const GridPoint d : directions) {
    if (std::find(chosen.begin(), chosen.end(), d) != chosen.end()) {
      const GridPoint step = turned(d, quarters);
      const std::int32_t length = std::max(std::abs(d.x), std::abs(d.y));
      const std::int32_t most = std::clamp(reach / length, 1, room(u, step, box));
      const auto times = static_cast<std::int32_t>(1 + random() % static_cast<unsigned>(most));
      ring.push_back({u.x + times * step.x, u.y + times * step.y});
    }
  }
  if (!is_open) {
    const auto first = static_cast<std::ptrdiff_t>(random() % ring.size());
    std::rotate(ring.begin(), ring.begin() + first, ring.end());
  }
  return ring;
}

void name_by_ring(VertexSplit& r, std::span<const RingCorner> ring) {
  const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
  const bool no_right = (r.flags & VertexSplit::kNoRight) != 0;
  const RingCorner& w = no_left ? ring.back() : ring.front();
  const RingCorner& vr = no_left ? ring[ring.size() - 2] : ring.back();
  r.w = w.position;
  r.vl = ring[no_left ? 0 : 1].position;
  r.vr = vr.position;
  r.flags =
      static_cast<std::uint16_t>(r.flags & ~(VertexSplit::kLeftVoid | VertexSplit::kRightVoid));
  if (!no_left && (w.flags & RingCorner::kVoid) != 0) {
    r.flags |= VertexSplit::kLeftVoid;
  }
  if (!no_right && (vr.flags & RingCorner::kVoid) != 0) {
    r.flags |= VertexSplit::kRightVoid;
  }
}

void hold_ring(VertexSplit& r, std::span<const RingCorner> ring, const HeightEncoding& heights) {
  Interval codes{heights.code(r.height_lo), heights.code(r.height_hi)};
  if (is_empty(codes)) {
    codes = {};
  }
  if ((r.flags & VertexSplit::kVertexVoid) == 0) {
    codes = united(codes, heights.code(r.height));
  }
  r.roi = united(r.roi, r.u);
  for (const RingCorner& c : ring) {
    r.roi = united(r.roi, c.position);
    if ((c.flags & RingCorner::kNoHeight) == 0) {
      codes = united(codes, heights.code(c.height));
    }
  }
  r.height_lo = is_empty(codes) ? no_heights(heights.type).lo : heights.bits(codes.lo);
  r.height_hi = is_empty(codes) ? no_heights(heights.type).hi : heights.bits(codes.hi);
}

void add_star(StarredRecords& records, VertexSplit r, const std::vector<GridPoint>& ring,
              const HeightEncoding& heights) {
  std::vector<RingCorner> corners;
  for (const GridPoint p : ring) {
    corners.push_back({p, r.height, kLivesOn, 0});
  }
  name_by_ring(r, corners);
  r.roi = {};
  r.height_lo = r.height_hi = r.height;
  hold_ring(r, corners, heights);
  add_star(records, r, corners);
}

void add_star(StarredRecords& records, VertexSplit r, const std::vector<RingCorner>& ring) {
  records.splits.push_back(r);
  records.corners.insert(records.corners.end(), ring.begin(), ring.end());
  records.ring_end.push_back(static_cast<std::uint32_t>(records.corners.size()));
}

}  // namespace ptin::test
