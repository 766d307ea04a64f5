// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin_link.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ptin {

namespace {

struct Side {
  VertexId low, high;
  TriangleId triangle;
  std::uint32_t place;  ///< The corner opposite to the edge.
};

/// On the border a vertex's triangle is the one without a clockwise neighbour, inside the first.
void link_vertices(Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      TriangleId& of_vertex = tin.vertices[tin.triangles[t].v[i]].triangle;
      if (of_vertex == kNone || tin.triangles[t].n[previous_corner(i)] == kNone) {
        of_vertex = t;
      }
    }
  }
}

}  // namespace

void link_tin(Tin& tin) {
  std::vector<Side> sides;
  sides.reserve(3 * tin.triangles.size());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const VertexId a = tin.triangles[t].v[next_corner(i)];
      const VertexId b = tin.triangles[t].v[previous_corner(i)];
      sides.push_back({std::min(a, b), std::max(a, b), t, static_cast<std::uint32_t>(i)});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low     ? a.low < b.low
           : a.high != b.high ? a.high < b.high
                              : a.triangle < b.triangle;
  });
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side& a = sides[i];
    const Side& b = sides[i + 1];
    if (a.low == b.low && a.high == b.high) {
      tin.triangles[a.triangle].n[a.place] = b.triangle;
      tin.triangles[b.triangle].n[b.place] = a.triangle;
    }
  }
  link_vertices(tin);
}

}  // namespace ptin
