// SPDX-License-Identifier: GPL-3.0-or-later
//
// Neighbours of triangles, and a triangle of each vertex, from corners alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/mesh/tin.h"

namespace ptin {

/// A side of a triangle. Sorting sides by `edge` brings those of one edge together.
struct TriangleSide {
  std::uint64_t edge;  ///< The ids of both ends, the smaller id in the upper 32 bits.
  TriangleId triangle;
  std::uint32_t place;  ///< The corner opposite to the side: 0, 1 or 2.
};

/// All sides of triangles 0 to `count` - 1, whose corner i is `corner(t, i)`.
template <typename CornerOf>
[[nodiscard]] std::vector<TriangleSide> sides_of(std::size_t count, const CornerOf& corner) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * count);
  for (TriangleId t = 0; t < count; ++t) {
    for (int i = 0; i < 3; ++i) {
      const VertexId a = corner(t, next_corner(i));
      const VertexId b = corner(t, previous_corner(i));
      sides.push_back({(std::uint64_t{std::min(a, b)} << 32) | std::max(a, b), t,
                       static_cast<std::uint32_t>(i)});
    }
  }
  return sides;
}

/// Calls join(a, b) for the two sides of every edge that two triangles share. Where more than two
/// share an edge, its sides are joined two by two in the order of their triangles. Sorts `sides`.
/// Cost: O(n log n).
template <typename Join>
void join_sides(std::vector<TriangleSide>& sides, const Join& join) {
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& a, const TriangleSide& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
  });
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].edge == sides[i + 1].edge) {
      join(sides[i], sides[i + 1]);
      ++i;
    }
  }
}

/// Makes neighbours of triangles that share an edge, where a side has none yet. Where more than two share
/// one, they are joined two by two in their order.
/// REQUIRES: corners are vertices.
/// Cost: linear, as long as no vertex has many such sides; 12 bytes for each of them, and 8 a vertex.
void link_sides(Tin& tin);

/// Fills Triangle::n and Vertex::triangle; border vertices point where invariant I6
/// (mesh/validate.h) says. Triangles that do not fit together, as a damaged file may have them,
/// become a mesh that validate() refuses.
/// REQUIRES: no neighbour is set; corners are vertices.
/// Cost: as link_sides().
void link_tin(Tin& tin);

}  // namespace ptin
