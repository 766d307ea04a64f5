// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/edges_file.h"

#include <utility>

namespace ptin {

void put_edges(ArrayFileWriter& file, const FixedEdges& edges) {
  file.put(edges.vertices());
  file.put(edges.edges());
  file.put(edges.sides_without_ground());
}

FixedEdges take_edges(ArrayFileReader& file) {
  LineGraph lines;
  lines.vertices = file.take_copy<LineVertex>();
  lines.edges = file.take_copy<LineEdge>();
  lines.without_ground = file.take_copy<SideWithoutGround>();
  return FixedEdges(std::move(lines));
}

}  // namespace ptin
