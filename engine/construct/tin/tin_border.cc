// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_border.h"

#include <algorithm>

namespace ptin {

void BorderFinder::add(const GridTriangle& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    const GridVertex& from = t.corners[i];
    const GridVertex& to = t.corners[i == 2 ? 0 : i + 1];
    const VertexKey a = key_of(from.position), b = key_of(to.position);
    piece_.push_back(a < b ? Side{a, b, from.height, to.height, 0}
                           : Side{b, a, to.height, from.height, 1});
  }
  if (piece_.size() >= 3 * kPiece) {
    clear_piece();
  }
}

/// Takes out the edges that have one triangle on each side. The others go to the sorter: triangles
/// of other pieces may lie beside them.
void BorderFinder::clear_piece() {
  std::sort(piece_.begin(), piece_.end());
  for (std::size_t first = 0; first < piece_.size();) {
    std::size_t end = first + 1;
    while (end < piece_.size() && piece_[end].low == piece_[first].low &&
           piece_[end].high == piece_[first].high) {
      ++end;
    }
    if (end - first != 2 || piece_[first].is_reversed == piece_[first + 1].is_reversed) {
      for (; first < end; ++first) {
        edges_.add(piece_[first]);
      }
    }
    first = end;
  }
  piece_.clear();
}

TinBorder border_in_memory(std::span<const GridEdge> edges) {
  TinBorder border;
  std::vector<GridVertex> vertices;
  for (const GridEdge& e : edges) {  // each vertex of a border is where some edge begins
    vertices.push_back(e.from);
  }
  // The lowest of several vertices at one position stays.
  std::sort(vertices.begin(), vertices.end(), [](const GridVertex& a, const GridVertex& b) {
    return std::pair(key_of(a.position), a.height) < std::pair(key_of(b.position), b.height);
  });
  vertices.erase(std::unique(vertices.begin(), vertices.end(),
                             [](const GridVertex& a, const GridVertex& b) {
                               return a.position == b.position;
                             }),
                 vertices.end());
  for (const GridVertex& v : vertices) {
    border.positions.push_back(v.position);
    border.heights.push_back(v.height);
  }
  const auto number = [&](const GridVertex& v) {
    return vertex_number(vertices, key_of(v.position));
  };
  for (const GridEdge& e : edges) {
    border.edges.push_back({number(e.from), number(e.to)});
  }
  std::sort(border.edges.begin(), border.edges.end(), [](const BorderEdge& a, const BorderEdge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  return border;
}

}  // namespace ptin
