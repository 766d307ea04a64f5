// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/polygon_oracle.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>

namespace ptin::reference {

namespace {

Rational turn_at(const RationalPoint& o, const RationalPoint& a, const RationalPoint& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

bool lies_between(const RationalPoint& a, const RationalPoint& b, const RationalPoint& p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

}  // namespace

RationalPoint rational_of(MapPoint p) { return {Rational(p.x), Rational(p.y)}; }

std::vector<std::pair<RationalPoint, RationalPoint>> sides_of(const Polygon& polygon) {
  std::vector<std::pair<RationalPoint, RationalPoint>> sides;
  for (const std::vector<MapPoint>& ring : polygon.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      sides.emplace_back(rational_of(ring[i]), rational_of(ring[(i + 1) % ring.size()]));
    }
  }
  return sides;
}

bool polygon_holds(const Polygon& polygon, const RationalPoint& p) {
  bool is_odd = false;
  for (const auto& [a, b] : sides_of(polygon)) {
    const Rational turn = turn_at(a, b, p);
    if (turn == 0 && lies_between(a, b, p)) return true;
    if ((a.y <= p.y) != (b.y <= p.y) && (turn > 0) == (b.y > a.y)) is_odd = !is_odd;
  }
  return is_odd;
}

double distance_to_border(const Polygon& polygon, MapPoint p) {
  double least = INFINITY;
  for (const std::vector<MapPoint>& ring : polygon.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const MapPoint a = ring[i], b = ring[(i + 1) % ring.size()];
      const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
      const double along = length2 > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length2 : 0.0;
      const double share = std::clamp(along, 0.0, 1.0);
      least = std::min(least, std::hypot(p.x - a.x - share * dx, p.y - a.y - share * dy));
    }
  }
  return least;
}

std::vector<Shares> stretches_in(const Polygon& polygon, MapPoint from, MapPoint to) {
  const RationalPoint p = rational_of(from), q = rational_of(to);
  std::set<Rational> shares = {Rational(0), Rational(1)};
  const Rational length2 = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
  for (const auto& [a, b] : sides_of(polygon)) {
    const Rational at_a = turn_at(p, q, a), at_b = turn_at(p, q, b);
    if (at_a * at_b < 0) {
      const Rational at_p = turn_at(a, b, p), at_q = turn_at(a, b, q);
      if (at_p * at_q < 0) shares.insert(at_p / (at_p - at_q));
    }
    for (const auto& [turn, end] : {std::pair{at_a, a}, std::pair{at_b, b}}) {
      if (turn == 0 && lies_between(p, q, end)) {
        shares.insert(((end.x - p.x) * (q.x - p.x) + (end.y - p.y) * (q.y - p.y)) / length2);
      }
    }
  }
  std::vector<Shares> stretches;
  for (auto low = shares.begin(), high = std::next(low); high != shares.end(); ++low, ++high) {
    if (!polygon_holds(polygon, along(p, q, (*low + *high) / 2))) continue;
    if (!stretches.empty() && stretches.back().to == *low) {
      stretches.back().to = *high;
    } else {
      stretches.push_back({*low, *high});
    }
  }
  return stretches;
}

Polygon any_polygon(std::mt19937_64& random, const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  const auto coordinate = [&](std::int32_t low, std::int32_t high) {
    const double on_grid = low - 1 + double(random() % (std::uint64_t(high - low) + 3));
    return random() % 2 == 0 ? on_grid : on_grid + 0.1 + 0.8 * double(random() % 1000003) / 1e6;
  };
  const auto corner = [&] {
    return facts.map.to_map(coordinate(b.min_x, b.max_x), coordinate(b.min_y, b.max_y));
  };
  const auto ring_around = [&](MapPoint middle, double size) {
    std::vector<MapPoint> ring;
    const int corners = 3 + static_cast<int>(random() % 9);
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      const double r = size * (0.3 + 0.7 * double(random() % 1000003) / 1e6);
      ring.push_back({middle.x + r * std::cos(angle), middle.y + r * std::sin(angle)});
    }
    return ring;
  };
  const std::uint64_t kind = random() % 4;
  if (kind == 0) {  // corners anywhere, sides that may cross
    std::vector<MapPoint> ring;
    for (std::uint64_t i = 3 + random() % 4; i > 0; --i) ring.push_back(corner());
    return {{ring}};
  }
  if (kind == 1) {
    const MapPoint p = corner(), q = corner();
    return {{{p, {q.x, p.y}, q, {p.x, q.y}}}};
  }
  const double size = facts.map.step_x * std::max(b.max_x - b.min_x, 2) / 2.0;
  const MapPoint middle = corner();
  Polygon star{{ring_around(middle, size)}};
  if (kind == 3) star.rings.push_back(ring_around(middle, size * 0.25));  // in its core: a hole
  return star;
}

Hierarchy small_terrain(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto size = [&] { return 2 + static_cast<int>(random() % 6); };
  if (seed % 3 == 0) return simplify(random_points(random, 10 + size() * 6, 40), random);
  const int spacing = 1 + static_cast<int>(random() % 4);
  return simplify(random_grid(random, size(), size(), spacing, seed % 3 == 1 ? 0.15 : 0.0), random);
}

}  // namespace ptin::reference
