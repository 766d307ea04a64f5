// SPDX-License-Identifier: GPL-3.0-or-later
//
// PLY as QGIS (MDAL), Blender and MeshLab read it: binary little-endian; vertices x y z in lower
// case, as doubles; faces as a list `vertex_indices` of int behind a uchar count, as the first
// property of the face. MDAL reads the CRS from `comment crs: ...`. No header line is empty, since
// MDAL splits lines into words without looking.
#include <cstring>

#include "engine/error.h"
#include "tools/formats/crs_lines.h"
#include "tools/formats/mesh_writer.h"

namespace ptin::tools {

namespace {

std::string header_of(const Mesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by ptin\n";
  text += crs_lines(mesh.crs, "comment ");
  text += "element vertex " + std::to_string(mesh.vertices.size()) + "\n";
  text += "property double x\nproperty double y\nproperty double z\n";
  text += "element face " + std::to_string(mesh.triangles.size()) + "\n";
  text += "property list uchar int vertex_indices\nend_header\n";
  return text;
}

}  // namespace

void write_ply(const Mesh& mesh, ByteSink& out) {
  if (mesh.vertices.size() > INT32_MAX) {
    refuse("PLY holds at most 2^31 - 1 vertices; ask for a window or an error");
  }
  out.write(header_of(mesh));
  for (const auto& vertex : mesh.vertices) out.write_value(vertex);
  for (const auto& triangle : mesh.triangles) {
    char face[1 + 3 * sizeof(std::uint32_t)];
    face[0] = 3;
    std::memcpy(face + 1, triangle.data(), 3 * sizeof(std::uint32_t));
    out.write(face, sizeof face);
  }
}

}  // namespace ptin::tools
