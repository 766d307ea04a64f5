// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/link.h"

namespace ptin {

void link_tin(Tin& tin) {
  std::vector<TriangleSide> sides =
      sides_of(tin.triangles.size(), [&](TriangleId t, int i) { return tin.triangles[t].v[i]; });
  join_sides(sides, [&](const TriangleSide& a, const TriangleSide& b) {
    tin.triangles[a.triangle].n[a.place] = b.triangle;
    tin.triangles[b.triangle].n[b.place] = a.triangle;
  });
  point_vertices(tin);
}

}  // namespace ptin
