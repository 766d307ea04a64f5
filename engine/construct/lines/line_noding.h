// SPDX-License-Identifier: GPL-3.0-or-later
//
// From lines to edges that meet at their ends alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/construct/grid/grid_vertex.h"
#include "engine/geometry/affine.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A straight piece of a line between two vertices, a < b by place.
struct LineEdge {
  std::uint32_t a = 0, b = 0;
  bool breakline = false;        ///< Some breakline goes along it.
  bool boundary = false;         ///< An odd number of sides of the boundary lie along it.
  std::array<bool, 2> unused{};  ///< In the place of padding: edges are written as they are.
};

/// A side of the boundary, or a part of one, where there is no ground. It only divides inside from
/// outside.
struct SideWithoutGround {
  GridPoint a, b;
};

/// Lines on the grid, before and after noding.
struct LineGraph {
  std::vector<GridVertex> vertices;
  std::vector<LineEdge> edges;
  std::vector<SideWithoutGround> without_ground;  ///< No edges: noding leaves them alone.
  /// How far the grid position of a crossing is from where the lines cross, at most; grid units.
  double largest_bend = 0.0;
};

/// How heights are compared where lines meet, and how a place is named.
struct NodingRules {
  double height_step = 0.0;  ///< Heights that differ by no more are equal.
  /// False: heights of lines that meet are not compared, since they are those of one surface but for
  /// rounding.
  bool compares_heights = true;
  bool whole_heights = false;   ///< Heights are codes: those of crossings are rounded.
  double height_of_unit = 1.0;  ///< What one unit of GridVertex::height is in the height's unit.
  AffineMap map;                ///< For messages.
  /// What there is memory for, crossings included.
  std::uint64_t most_vertices = UINT32_MAX - 1;
};

/// Divides lines until their edges have nothing in common but ends, and joins what falls together:
/// - vertices at one position become one; their heights must be equal within a height step, and the
///   lowest stands;
/// - a vertex inside of an edge divides it; its height stands;
/// - where two edges cross, both get a vertex at the grid position nearest to the crossing, with the
///   lower of their two heights, or go through the vertex that is there already, at its height, which
///   must be theirs in the same sense. This moves edges by
///   at most half a grid unit in x and in y, which may make new crossings: they are treated in turn,
///   until there are none;
/// - edges that fall together become one, and of a boundary's two cancel.
/// Where an edge meets another one or a vertex, the two heights may differ by a height step and by
/// what the edges rise over a grid unit, since grid positions are not known any better.
/// The result does not depend on the order of lines. Vertices and edges are sorted by position.
/// @throws Error  invalid_argument  heights differ where lines meet (the message names the place and
///                                  both heights); lines cross without end within a grid unit
///                resource_exhausted  more vertices than the rules allow
///                cancelled
/// Cost: O(n log n + meetings) a round; mostly two or three rounds.
[[nodiscard]] LineGraph node_lines(LineGraph&& lines, const NodingRules& rules,
                                   const std::stop_token& stop = {});

}  // namespace ptin
