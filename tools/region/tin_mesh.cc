// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/tin_mesh.h"

namespace ptin::tools {

Mesh surface_mesh(const RefinedTin& refined, const StoreFacts& facts) {
  const Tin& tin = refined.tin;
  Mesh mesh;
  std::vector<std::uint32_t> place(tin.vertices.size(), kNone);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t) || tin.classes[t] == TriangleClass::kVoid) continue;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId v = tin.triangles[t].v[i];
      if (place[v] == kNone) {
        place[v] = static_cast<std::uint32_t>(mesh.vertices.size());
        const GridPoint p = tin.position(v);
        const MapPoint at = facts.map.to_map(p.x, p.y);
        mesh.vertices.push_back({at.x, at.y, facts.heights.height(tin.vertices[v].height)});
      }
      corners[i] = place[v];
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

}  // namespace ptin::tools
