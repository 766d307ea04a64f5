// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ: map coordinates as they are (x east, y north, z up), every digit that a double
// needs, indices from 1.
#include "tools/formats/mesh_writer.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

void write_obj(const Mesh& mesh, ByteSink& out) {
  std::string line = "# written by ptin; x east, y north, z up\n";
  if (!mesh.crs.horizontal_text().empty()) line += "# crs: " + mesh.crs.horizontal_text() + "\n";
  if (!mesh.crs.vertical_text().empty())
    line += "# vertical_crs: " + mesh.crs.vertical_text() + "\n";
  out.write(line);
  for (const auto& vertex : mesh.vertices) {
    line.assign(1, 'v');
    for (const double coordinate : vertex) {
      line += ' ';
      append_number(line, coordinate);
    }
    out.write(line += '\n');
  }
  for (const auto& triangle : mesh.triangles) {
    line.assign(1, 'f');
    for (const std::uint32_t vertex : triangle) {
      line += ' ';
      append_number(line, std::uint64_t{vertex} + 1);
    }
    out.write(line += '\n');
  }
}

}  // namespace ptin::tools
