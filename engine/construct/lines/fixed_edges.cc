// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/fixed_edges.h"

#include <algorithm>
#include <utility>

namespace ptin {

FixedEdges::FixedEdges(LineGraph&& graph) : graph_(std::move(graph)) {
  has_boundary_ =
      !graph_.without_ground.empty() || std::any_of(graph_.edges.begin(), graph_.edges.end(),
                                                    [](const LineEdge& e) { return e.boundary; });
  boxes_ = EdgeBoxes(graph_);
  std::vector<GridBox> boxes;
  for (const SideWithoutGround& s : graph_.without_ground) {
    boxes.push_back(united(box_of(s.a), s.b));
  }
  boxes_without_ground_ = PackedBoxes(std::move(boxes));
  std::vector<LineEdge> kept;
  for (const LineEdge& e : graph_.edges) {
    const GridPoint a = graph_.vertices[e.a].position, b = graph_.vertices[e.b].position;
    const bool is_inside =
        !has_boundary_ || holds_scaled(std::int64_t{a.x} + b.x, std::int64_t{a.y} + b.y, 2);
    if (e.boundary || (e.breakline && is_inside)) {
      kept.push_back(e);
    }
  }
  if (kept.size() < graph_.edges.size()) {
    graph_.edges = std::move(kept);
    boxes_ = EdgeBoxes(graph_);
  }
  index();
}

/// Lets go of vertices that no edge needs, and finds the others by their positions.
void FixedEdges::index() {
  constexpr std::uint32_t kUnused = UINT32_MAX;
  std::vector<std::uint32_t> place(graph_.vertices.size(), kUnused);
  for (const LineEdge& e : graph_.edges) {
    place[e.a] = place[e.b] = 0;
  }
  std::uint32_t used = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] != kUnused) {
      graph_.vertices[used] = graph_.vertices[v];
      place[v] = used++;
    }
  }
  graph_.vertices.resize(used);
  for (LineEdge& e : graph_.edges) {
    e.a = place[e.a];
    e.b = place[e.b];
  }
  by_place_ = KeyTable(used);
  for (std::uint32_t v = 0; v < used; ++v) {
    by_place_.insert(key_of(graph_.vertices[v].position), v);
  }
}

/// Whether the point (x, y) / scale lies in the boundary or on it. With a scale of at most 3 the
/// products are below 3 * 2^60, and 64 bits hold their difference.
bool FixedEdges::holds_scaled(std::int64_t x, std::int64_t y, std::int64_t scale) const {
  if (!has_boundary_) {
    return true;
  }
  bool is_inside = false, is_on = false;
  const auto is_beside = [&](const GridBox& box) {
    return box.min_y * scale <= y && y <= box.max_y * scale && x <= box.max_x * scale;
  };
  const auto pass = [&](GridPoint a, GridPoint b) {
    const std::int64_t bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
    const std::int64_t px = x - a.x * scale, py = y - a.y * scale;
    const std::int64_t side = bx * py - by * px;
    if (side == 0) {
      is_on = is_on || x >= std::min(a.x, b.x) * scale;
    } else if ((a.y * scale > y) != (b.y * scale > y) && (side > 0) == (by > 0)) {
      is_inside = !is_inside;
    }
  };
  boxes_.visit(is_beside, [&](std::uint32_t number) {
    const LineEdge& e = graph_.edges[number];
    if (e.boundary) {
      pass(graph_.vertices[e.a].position, graph_.vertices[e.b].position);
    }
  });
  boxes_without_ground_.visit(is_beside, [&](std::size_t i) {
    pass(graph_.without_ground[i].a, graph_.without_ground[i].b);
  });
  return is_inside || is_on;
}

bool FixedEdges::holds(GridPoint p) const { return holds_scaled(p.x, p.y, 1); }

bool FixedEdges::holds(GridPoint a, GridPoint b, GridPoint c) const {
  return holds_scaled(std::int64_t{a.x} + b.x + c.x, std::int64_t{a.y} + b.y + c.y, 3);
}

}  // namespace ptin
