// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/star.h"

namespace ptin {

void walk_star(const Tin& tin, VertexId v, Star& star) {
  star.center = v;
  star.triangles.clear();
  star.link.clear();
  const TriangleId first = tin.vertices[v].triangle;
  TriangleId t = first;
  do {
    const Triangle& triangle = tin.triangles[t];
    const int c = corner_of(triangle, v);
    star.triangles.push_back(t);
    star.link.push_back(triangle.v[next_corner(c)]);
    const TriangleId next =
        triangle.n[next_corner(c)];  // across the edge from v to the third corner
    if (next == kNone) {
      star.link.push_back(triangle.v[previous_corner(c)]);
      star.closed = false;
      return;
    }
    t = next;
  } while (t != first);
  star.closed = true;
}

}  // namespace ptin
