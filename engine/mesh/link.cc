// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/link.h"

#include <algorithm>
#include <vector>

namespace ptin {

namespace {

/// A side of a triangle, kept with the smaller one of its two ends.
struct SideOfVertex {
  VertexId other;  ///< The larger one.
  TriangleId triangle;
  int place;  ///< The corner opposite to the side; -1: it is joined.
};

/// Calls visit(smaller end, larger end, place) for the sides of a triangle that have no neighbour.
template <typename Visit>
void for_each_side(const Triangle& t, const Visit& visit) {
  for (int i = 0; i < 3; ++i) {
    if (t.n[i] != kNone) {
      continue;
    }
    const VertexId a = t.v[next_corner(i)];
    const VertexId b = t.v[previous_corner(i)];
    visit(std::min(a, b), std::max(a, b), i);
  }
}

}  // namespace

void link_sides(Tin& tin) {
  std::vector<std::uint32_t> end(tin.vertices.size() + 1);
  for (const Triangle& t : tin.triangles) {
    for_each_side(t, [&](VertexId a, VertexId /*b*/, int /*place*/) { ++end[a + 1]; });
  }
  for (std::size_t v = 0; v + 1 < end.size(); ++v) {
    end[v + 1] += end[v];
  }
  // Where the sides of a vertex end so far; they begin where those of the vertex before it end.
  std::vector<SideOfVertex> sides(end.back());
  std::vector<std::uint32_t> so_far(end.begin(), end.end() - 1);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for_each_side(tin.triangles[t], [&](VertexId a, VertexId b, int place) {
      const auto first = sides.begin() + end[a];
      const auto last = sides.begin() + so_far[a];
      const auto twin = std::find_if(
          first, last, [&](const SideOfVertex& s) { return s.other == b && s.place >= 0; });
      if (twin == last) {
        sides[so_far[a]++] = {b, t, place};
        return;
      }
      tin.triangles[t].n[place] = twin->triangle;
      tin.triangles[twin->triangle].n[twin->place] = t;
      twin->place = -1;
    });
  }
}

void link_tin(Tin& tin) {
  link_sides(tin);
  point_vertices(tin);
}

}  // namespace ptin
