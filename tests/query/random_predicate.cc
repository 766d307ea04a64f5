// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/random_predicate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ptin::reference {

namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Half of the coordinates lie on the grid exactly.
double coordinate(std::mt19937_64& random, double low, double high) {
  const double margin = 0.1 * (high - low) + 1;
  const double v = uniform(random, low - margin, high + margin);
  return random() % 2 == 0 ? std::round(v) : v;
}

MapPoint position(std::mt19937_64& random, const StoreFacts& f) {
  const double x = coordinate(random, f.bounds.min_x, f.bounds.max_x);
  const double y = coordinate(random, f.bounds.min_y, f.bounds.max_y);
  return f.map.to_map(x, y);
}

Window window_of(MapPoint a, MapPoint b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

std::vector<MapPoint> ring_around(std::mt19937_64& random, MapPoint center, double radius) {
  const int corners = 3 + static_cast<int>(random() % 12);
  std::vector<MapPoint> ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const double r = radius * uniform(random, 0.3, 1.0);
    ring.push_back({center.x + r * std::cos(angle), center.y + r * std::sin(angle)});
  }
  return ring;
}

Polygon random_polygon(std::mt19937_64& random, const StoreFacts& f) {
  Polygon polygon;
  if (random() % 3 == 0) {  // any corners: the ring crosses itself
    std::vector<MapPoint> ring;
    const std::size_t corners = 3 + random() % 5;
    for (std::size_t i = 0; i < corners; ++i) {
      ring.push_back(position(random, f));
    }
    if (ring.front() == ring.back()) {
      ring.back().x += f.map.step_x;  // a repeated last point would be dropped
    }
    polygon.rings.push_back(ring);
    return polygon;
  }
  const MapPoint center = position(random, f);
  const double size = f.map.step_x * (f.bounds.max_x - f.bounds.min_x + 1);
  const double radius = size * uniform(random, 0.02, 0.6);
  polygon.rings.push_back(ring_around(random, center, radius));
  if (random() % 2 == 0) {
    polygon.rings.push_back(ring_around(random, center, radius * 0.3));
  }
  return polygon;
}

}  // namespace

Region random_region(std::mt19937_64& random, const StoreFacts& f) {
  switch (random() % 5) {
    case 0:
      return position(random, f);
    case 1:
      return Segment{position(random, f), position(random, f)};
    case 2:
    case 3:
      return random_polygon(random, f);
    default:
      return window_of(position(random, f), position(random, f));
  }
}

PredicatePtr random_predicate(std::mt19937_64& random, const StoreFacts& f, int depth) {
  const double lowest = f.min_height <= f.max_height ? f.min_height - 5 : -5.0;
  const double highest = f.min_height <= f.max_height ? f.max_height + 5 : 5.0;
  if (depth > 0 && random() % 2 == 0) {
    std::vector<PredicatePtr> parts;
    const std::size_t count = 1 + random() % 3;
    for (std::size_t i = 0; i < count; ++i) {
      parts.push_back(random_predicate(random, f, depth - 1));
    }
    return random() % 2 == 0 ? all_of(std::move(parts)) : any_of(std::move(parts));
  }
  switch (random() % 8) {
    case 0:
      return error_above(random() % 4 == 0 ? 0.0 : std::exp(uniform(random, -3.0, 4.0)));
    case 1:
      return contains_height(uniform(random, lowest, highest), f.heights);
    case 2: {
      const double low = uniform(random, lowest, highest);
      return heights_meet(low, low + uniform(random, 0.0, 10.0), f.heights);
    }
    case 3: {
      View view;
      view.eye = position(random, f);
      if (random() % 2 == 0) {
        view.eye_height = uniform(random, lowest, highest);
      }
      view.tau = random() % 8 == 0 ? 0.0 : std::exp(uniform(random, -5.0, 1.0));
      view.ground_per_map_y = uniform(random, 0.5, 2.0);
      return seen_from(view, f.map, f.heights);
    }
    case 4:
      return random() % 4 == 0 ? everything() : error_above(uniform(random, 0.0, 30.0));
    default:
      return meets_region(random_region(random, f), f.map);
  }
}

}  // namespace ptin::reference
