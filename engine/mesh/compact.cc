// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/compact.h"

namespace ptin {

namespace {

/// Numbers what is kept, one after the other.
template <typename T, typename IsKept>
Renumbering numbered(const std::vector<T>& all, const IsKept& is_kept) {
  Renumbering number(all.size(), kNone);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_kept(all[i])) {
      number[i] = next++;
    }
  }
  return number;
}

}  // namespace

Renumbering compact_triangles(Tin& tin) {
  Renumbering number = numbered(tin.triangles, [](const Triangle& t) { return t.v[0] != kNone; });
  keep_numbered(number, tin.triangles);
  keep_numbered(number, tin.classes);
  for (Triangle& t : tin.triangles) {
    for (TriangleId& n : t.n) {
      n = n == kNone ? kNone : number[n];
    }
  }
  for (Vertex& v : tin.vertices) {
    v.triangle = v.triangle == kNone ? kNone : number[v.triangle];
  }
  return number;
}

Renumbering compact_vertices(Tin& tin) {
  Renumbering number = numbered(tin.vertices, [](const Vertex& v) { return v.triangle != kNone; });
  keep_numbered(number, tin.vertices);
  keep_numbered(number, tin.has_height);
  for (Triangle& t : tin.triangles) {
    for (VertexId& v : t.v) {
      v = number[v];
    }
  }
  return number;
}

}  // namespace ptin
