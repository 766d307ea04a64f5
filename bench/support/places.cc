// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/places.h"

#include <cmath>
#include <random>

namespace ptin::bench {

namespace {

/// The window of so large a side whose south-western corner lies at x and y; all as shares of the
/// bounding box.
Window window_of(const StoreFacts& facts, double x, double y, double side) {
  const GridBox& b = facts.bounds;
  const auto at = [&](double right, double up) {
    return facts.map.to_map(b.min_x + right * (b.max_x - b.min_x),
                            b.min_y + up * (b.max_y - b.min_y));
  };
  const MapPoint low = at(x, y), high = at(x + side, y + side);
  return {low.x, low.y, high.x, high.y};
}

double side_of(double area_ppm) { return std::sqrt(area_ppm * 1e-6); }

}  // namespace

std::vector<MapPoint> random_points(const StoreFacts& facts, std::size_t count) {
  std::mt19937_64 random(1997);
  std::uniform_real_distribution<double> x(facts.bounds.min_x, facts.bounds.max_x);
  std::uniform_real_distribution<double> y(facts.bounds.min_y, facts.bounds.max_y);
  std::vector<MapPoint> points(count);
  for (MapPoint& p : points) p = facts.map.to_map(x(random), y(random));
  return points;
}

std::vector<Window> random_windows(const StoreFacts& facts, std::size_t count, double area_ppm,
                                   std::uint64_t seed) {
  const double side = side_of(area_ppm);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0.0, 1.0 - side);
  std::vector<Window> windows;
  while (windows.size() < count) {
    const double x = place(random);
    const double y = place(random);
    windows.push_back(window_of(facts, x, y, side));
  }
  return windows;
}

Window window_at(const StoreFacts& facts, double area_ppm, double shift) {
  const double side = side_of(area_ppm);
  const double corner = (1.0 - side) / 3;
  return window_of(facts, corner + shift * side, corner, side);
}

}  // namespace ptin::bench
