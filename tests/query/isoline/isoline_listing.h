// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines as numbers to compare, and levels to ask for.
#pragma once

#include <random>
#include <vector>

#include "engine/query/isoline/isoline.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin::reference {

using Listing = std::vector<std::vector<double>>;

/// Everything about the lines, in their order.
inline Listing listing(const Isolines& lines) {
  Listing all;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    all.push_back({double(line.level), double(line.ring)});
    for (const MapPoint& p : line.points) all.back().insert(all.back().end(), {p.x, p.y});
  }
  return all;
}

/// Heights of vertices (plateaus, saddles and peaks among them), heights between.
inline std::vector<double> random_levels(std::mt19937_64& random, const Hierarchy& h, int count) {
  std::vector<double> levels;
  std::uniform_real_distribution<double> anywhere(h.facts.min_height - 1, h.facts.max_height + 1);
  for (int i = 0; i < count; ++i) {
    const Vertex& v = h.full.vertices[random() % h.full.vertices.size()];
    levels.push_back(i % 2 == 0 ? h.facts.heights.height(v.height) : anywhere(random));
  }
  return levels;
}

}  // namespace ptin::reference
