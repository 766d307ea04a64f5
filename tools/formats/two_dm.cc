// SPDX-License-Identifier: GPL-3.0-or-later
//
// SMS 2DM: MESH2D, then E3T (element, three nodes, material) and ND (node, x, y, z), ids from 1.
// The format has no place for a CRS; QGIS asks for it, or reads a .prj beside the file.
#include "tools/formats/mesh_writer.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

void write_2dm(const Mesh& mesh, ByteSink& out) {
  out.write("MESH2D\n");
  std::string line;
  std::uint64_t id = 0;
  for (const auto& triangle : mesh.triangles) {
    line = "E3T ";
    append_number(line, ++id);
    for (const std::uint32_t vertex : triangle) {
      line += ' ';
      append_number(line, std::uint64_t{vertex} + 1);
    }
    out.write(line += " 1\n");
  }
  id = 0;
  for (const auto& vertex : mesh.vertices) {
    line = "ND ";
    append_number(line, ++id);
    for (const double coordinate : vertex) {
      line += ' ';
      append_number(line, coordinate);
    }
    out.write(line += '\n');
  }
}

}  // namespace ptin::tools
