// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/lines_on_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/construct/lines/line_noding.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// Adds the lines of a set to a graph; returns by how much a vertex was moved at most.
double add_lines(const LineSet& set, const PointGrid& grid, bool is_boundary, LineGraph& to) {
  const auto has_ground = [&](std::size_t v) {
    return set.has_ground.empty() || set.has_ground[v] != 0;
  };
  double moved = 0.0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto line = set.line(i);
    for (std::size_t k = 0; k < line.size(); ++k) {
      const bool before = k > 0 && has_ground(first + k - 1), here = has_ground(first + k);
      if (here) {
        to.vertices.push_back({grid.position(line[k]), grid.height(line[k].z)});
      }
      moved = std::max(moved, grid.shift_of_line(line[k]));
      const auto v = static_cast<std::uint32_t>(to.vertices.size());
      if (before && here) {
        to.edges.push_back({v - 2, v - 1, !is_boundary, is_boundary});
      } else if (k > 0) {
        to.without_ground.push_back({grid.position(line[k - 1]), grid.position(line[k])});
      }
    }
    first += line.size();
  }
  return moved;
}

}  // namespace

LinesOnGrid put_on_grid(const SourceLines& lines, const PointGrid& grid,
                        const std::stop_token& stop) {
  LinesOnGrid result;
  LineGraph graph;
  result.largest_shift_plan = add_lines(lines.breaklines, grid, false, graph);
  if (!lines.rings_are_flat) {
    result.largest_shift_plan =
        std::max(result.largest_shift_plan, add_lines(lines.rings, grid, true, graph));
  }
  NodingRules rules;
  rules.compares_heights = !lines.are_laid;
  rules.whole_heights = grid.whole;
  rules.height_of_unit = grid.whole ? grid.heights.unit() : 1.0;
  rules.height_step = grid.whole ? 1.0 : grid.heights.unit();
  rules.map = grid.map();
  rules.most_vertices = lines.most_vertices;
  LineGraph noded = node_lines(std::move(graph), rules, stop);
  const double bend = noded.largest_bend * std::max(rules.map.step_x, rules.map.step_y);
  result.largest_shift_plan = std::max(result.largest_shift_plan, bend);
  result.edges = FixedEdges(std::move(noded));
  if (lines.rings.size() > 0 && !lines.rings_are_flat && !result.edges.has_boundary()) {
    refuse("the boundary encloses nothing", lines.files.back().path);
  }
  return result;
}

}  // namespace ptin
