// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/brute_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ptin::tools {

namespace {

const SourceSample& sample_at(const SampleWindow& w, std::int64_t x, std::int64_t y) {
  const std::int64_t width = std::int64_t{w.box.max_x} - w.box.min_x + 1;
  return w.samples[static_cast<std::size_t>((y - w.box.min_y) * width + (x - w.box.min_x))];
}

}  // namespace

GroundSteps ground_steps(const AffineMap& map, const Ground& ground, double grid_y) {
  if (!ground.geographic) return {map.step_x, map.step_y};
  const MapPoint unit = ground.per_map_unit({map.origin_x, map.origin_y + map.step_y * grid_y});
  return {map.step_x * unit.x * ground.metres_per_height,
          map.step_y * unit.y * ground.metres_per_height};
}

double depth_at(const SampleWindow& window, std::int32_t x, std::int32_t y,
                const GroundSteps& steps, double limit) {
  const bool is_void = sample_at(window, x, y).is_void;
  const double smaller = std::min(steps.x, steps.y);
  double nearest = std::numeric_limits<double>::infinity();
  // Looks around squares of growing radius, until no sample further out can be nearer.
  for (std::int64_t r = 1; static_cast<double>(r) * smaller <= std::min(limit, nearest); ++r) {
    const std::int64_t low_x = std::max<std::int64_t>(window.box.min_x, x - r);
    const std::int64_t high_x = std::min<std::int64_t>(window.box.max_x, x + r);
    const std::int64_t low_y = std::max<std::int64_t>(window.box.min_y, y - r);
    const std::int64_t high_y = std::min<std::int64_t>(window.box.max_y, y + r);
    if (low_x > x - r && low_y > y - r && high_x < x + r && high_y < y + r)
      break;  // The square lies around the window.
    const auto look = [&](std::int64_t px, std::int64_t py) {
      if (sample_at(window, px, py).is_void == is_void) return;
      const double dx = static_cast<double>(px - x) * steps.x;
      const double dy = static_cast<double>(py - y) * steps.y;
      nearest = std::min(nearest, std::sqrt(dx * dx + dy * dy));
    };
    for (std::int64_t py : {y - r, y + r}) {
      if (py < window.box.min_y || py > window.box.max_y) continue;
      for (std::int64_t px = low_x; px <= high_x; ++px) look(px, py);
    }
    for (std::int64_t px : {x - r, x + r}) {
      if (px < window.box.min_x || px > window.box.max_x) continue;
      for (std::int64_t py = low_y; py <= high_y; ++py) look(px, py);
    }
  }
  return nearest <= limit ? nearest : std::numeric_limits<double>::infinity();
}

void drop_lone_samples(SampleWindow& window) {
  const GridBox& b = window.box;
  const auto is_surface_cell = [&](std::int64_t x, std::int64_t y) {
    if (x < b.min_x || y < b.min_y || x >= b.max_x || y >= b.max_y) return false;
    return int{sample_at(window, x, y).is_void} + int{sample_at(window, x + 1, y).is_void} +
               int{sample_at(window, x, y + 1).is_void} +
               int{sample_at(window, x + 1, y + 1).is_void} <=
           1;
  };
  std::vector<std::size_t> lone;
  for (std::size_t i = 0; i < window.samples.size(); ++i) {
    const SourceSample& s = window.samples[i];
    if (s.is_void || is_surface_cell(s.x, s.y) || is_surface_cell(s.x - 1, s.y) ||
        is_surface_cell(s.x, s.y - 1) || is_surface_cell(s.x - 1, s.y - 1)) {
      continue;
    }
    lone.push_back(i);
  }
  for (const std::size_t i : lone) window.samples[i].is_void = window.samples[i].is_lone = true;
}

}  // namespace ptin::tools
