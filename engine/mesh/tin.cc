// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/tin.h"

#include <algorithm>

namespace ptin {

std::size_t Tin::alive_vertices() const noexcept {
  return static_cast<std::size_t>(std::count_if(
      vertices.begin(), vertices.end(), [](const Vertex& v) { return v.triangle != kNone; }));
}

std::size_t Tin::alive_triangles() const noexcept {
  return static_cast<std::size_t>(std::count_if(triangles.begin(), triangles.end(),
                                                [](const Triangle& t) { return t.v[0] != kNone; }));
}

void point_vertices(Tin& tin) {
  for (Vertex& v : tin.vertices) {
    v.triangle = kNone;
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    for (int c = 0; c < 3; ++c) {
      TriangleId& slot = tin.vertices[triangle.v[c]].triangle;
      if (slot == kNone || triangle.n[previous_corner(c)] == kNone) {
        slot = t;
      }
    }
  }
}

}  // namespace ptin
