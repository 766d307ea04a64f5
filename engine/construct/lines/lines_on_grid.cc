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
  double moved = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto line = set.line(i);
    for (std::size_t k = 0; k < line.size(); ++k) {
      const auto v = static_cast<std::uint32_t>(to.vertices.size());
      to.vertices.push_back({grid.position(line[k]), grid.height(line[k].z)});
      moved = std::max(moved, grid.shift_of_line(line[k]));
      if (k > 0) {
        to.edges.push_back({v - 1, v, !is_boundary, is_boundary});
      }
    }
  }
  return moved;
}

}  // namespace

LinesOnGrid put_on_grid(const SourceLines& lines, const PointGrid& grid,
                        const std::stop_token& stop) {
  LinesOnGrid result;
  LineGraph graph;
  result.largest_shift_plan = std::max(add_lines(lines.breaklines, grid, false, graph),
                                       add_lines(lines.rings, grid, true, graph));
  NodingRules rules;
  rules.whole_heights = grid.whole;
  rules.height_of_unit = grid.whole ? grid.heights.unit() : 1.0;
  rules.height_step = grid.whole ? 1.0 : grid.heights.unit();
  rules.map = grid.map();
  result.edges = FixedEdges(node_lines(std::move(graph), rules, stop));
  if (lines.rings.size() > 0 && !result.edges.has_boundary()) {
    refuse("the boundary encloses nothing", lines.files.back().path);
  }
  return result;
}

}  // namespace ptin
