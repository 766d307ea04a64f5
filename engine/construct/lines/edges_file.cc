// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/edges_file.h"

#include <utility>

namespace ptin {

void serialize(ArrayFileWriter& file, const FixedEdges& edges) {
  file.values(edges.vertices(), edges.edges(), edges.sides_without_ground());
}

void serialize(ArrayFileReader& file, FixedEdges& edges) {
  LineGraph lines;
  file.values(lines.vertices, lines.edges, lines.without_ground);
  edges = FixedEdges(std::move(lines));
}

}  // namespace ptin
