// SPDX-License-Identifier: GPL-3.0-or-later
//
// The edges of lines, found by their boxes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/construct/lines/line_noding.h"
#include "engine/geometry/box.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/packed_boxes.h"

namespace ptin {

/// Boxes of edges, packed along the Hilbert curve of their first ends. Threads: const.
class EdgeBoxes {
 public:
  EdgeBoxes() = default;
  /// Nothing is kept of the graph. Cost: O(n log n).
  explicit EdgeBoxes(const LineGraph& graph) : edges_(graph.edges.size()) {
    std::vector<std::uint64_t> place(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const GridPoint p = graph.vertices[graph.edges[e].a].position;
      place[e] = hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
    }
    std::iota(edges_.begin(), edges_.end(), 0U);
    std::sort(edges_.begin(), edges_.end(), [&](std::uint32_t e, std::uint32_t f) {
      return place[e] != place[f] ? place[e] < place[f] : e < f;
    });
    std::vector<GridBox> boxes;
    boxes.reserve(edges_.size());
    for (const std::uint32_t e : edges_) {
      boxes.push_back(united(box_of(graph.vertices[graph.edges[e].a].position),
                             graph.vertices[graph.edges[e].b].position));
    }
    boxes_ = PackedBoxes(std::move(boxes));
  }

  /// Calls visit(number of the edge) for each edge with meets(its box), in no order of numbers.
  /// REQUIRES: as PackedBoxes::visit().
  template <class Meets, class Visit>
  void visit(const Meets& meets, const Visit& visit) const {
    boxes_.visit(meets, [&](std::size_t i) { visit(edges_[i]); });
  }

 private:
  std::vector<std::uint32_t> edges_;  ///< Along the curve.
  PackedBoxes boxes_;
};

}  // namespace ptin
