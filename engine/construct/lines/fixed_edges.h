// SPDX-License-Identifier: GPL-3.0-or-later
//
// The edges that a triangulation must have: those of breaklines and of the boundary.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/lines/edge_boxes.h"
#include "engine/construct/lines/line_noding.h"
#include "engine/geometry/box.h"
#include "engine/geometry/key_table.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Noded edges in memory, and what they enclose. Vertices and edges have numbers. Threads: const.
class FixedEdges {
 public:
  FixedEdges() = default;
  /// Where some edge is of the boundary, edges outside of it are dropped, and vertices that no edge
  /// needs.
  /// @param graph  As node_lines() returns it, or what another object has of each.
  explicit FixedEdges(LineGraph&& graph);

  /// True when nothing is fixed, and nothing is outside.
  [[nodiscard]] bool is_empty() const noexcept { return graph_.edges.empty() && !has_boundary_; }
  [[nodiscard]] bool has_boundary() const noexcept { return has_boundary_; }
  [[nodiscard]] std::span<const GridVertex> vertices() const noexcept { return graph_.vertices; }
  [[nodiscard]] std::span<const LineEdge> edges() const noexcept { return graph_.edges; }
  [[nodiscard]] std::span<const SideWithoutGround> sides_without_ground() const noexcept {
    return graph_.without_ground;
  }
  /// The number of the vertex at a position; KeyTable::kAbsent where there is none.
  [[nodiscard]] std::uint32_t vertex_at(GridPoint p) const noexcept {
    return by_place_.find(key_of(p));
  }

  /// Calls visit(number) for each edge with meets(its box), in no order.
  /// REQUIRES: as PackedBoxes::visit().
  template <class Meets, class Visit>
  void visit(const Meets& meets, const Visit& visit) const {
    boxes_.visit(meets, visit);
  }

  /// True when a point lies in the boundary or on it: on one of its edges or sides without ground, or
  /// with an odd number of them to its right. Always true without a boundary. Cost: those beside it.
  [[nodiscard]] bool holds(GridPoint p) const;
  /// The same for the middle of a triangle. REQUIRES: no edge of the boundary crosses the triangle.
  [[nodiscard]] bool holds(GridPoint a, GridPoint b, GridPoint c) const;

 private:
  [[nodiscard]] bool holds_scaled(std::int64_t x, std::int64_t y, std::int64_t scale) const;
  void index();

  LineGraph graph_;
  EdgeBoxes boxes_;
  PackedBoxes boxes_without_ground_;
  KeyTable by_place_;
  bool has_boundary_ = false;
};

}  // namespace ptin
