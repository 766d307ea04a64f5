// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/mesh_crs.h"

#include "engine/crs/ground.h"

namespace ptin::tools {

void set_crs(Mesh& mesh, const CrsFacts& crs) {
  mesh.crs = crs.horizontal_text();
  mesh.vertical_crs = crs.vertical_text();
  if (mesh.vertices.empty()) return;
  const std::array<double, 3> middle = middle_of(mesh);
  const Ground ground = ground_of(crs);
  const MapPoint heights = ground.per_map_unit({middle[0], middle[1]});
  mesh.metres_per_unit = {heights.x * ground.metres_per_height,
                          heights.y * ground.metres_per_height, ground.metres_per_height};
}

}  // namespace ptin::tools
