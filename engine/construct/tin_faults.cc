// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin_faults.h"

#include <algorithm>
#include <utility>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// An undirected edge with the side on which its triangle lies.
struct Side {
  VertexId low, high;
  bool is_reversed;  ///< Runs from high to low.

  friend auto operator<=>(const Side&, const Side&) = default;
};

/// Sides of all triangles, those of one edge beside each other.
std::vector<Side> sides_of(std::span<const Corners> triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const Corners& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId from = t[i];
      const VertexId to = t[i == 2 ? 0 : i + 1];
      sides.push_back({std::min(from, to), std::max(from, to), from > to});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace

bool TinFaults::any() const noexcept {
  return no_area.count + turned_over.count + heights.count + shared_edges.count +
             t_junctions.count + crossings.count + covered.count >
         0;
}

bool turn_majority(std::span<const GridPoint> positions, std::vector<Corners>& triangles) {
  std::int64_t excess = 0;
  for (const Corners& t : triangles) {
    const std::int64_t sign = orient(positions[t[0]], positions[t[1]], positions[t[2]]);
    excess += sign > 0 ? 1 : (sign < 0 ? -1 : 0);
  }
  if (excess >= 0) {
    return false;
  }
  for (Corners& t : triangles) {
    std::swap(t[1], t[2]);
  }
  return true;
}

void check_orientation(std::span<const GridPoint> positions, std::span<const Corners> triangles,
                       TinFaults& faults) {
  for (const Corners& t : triangles) {
    const std::int64_t sign = orient(positions[t[0]], positions[t[1]], positions[t[2]]);
    if (sign <= 0) {
      (sign == 0 ? faults.no_area : faults.turned_over).add(positions[t[0]]);
    }
  }
}

std::vector<BorderEdge> border_of(std::span<const GridPoint> positions,
                                  std::span<const Corners> triangles, TinFaults& faults) {
  const std::vector<Side> sides = sides_of(triangles);
  std::vector<BorderEdge> border;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first;
    std::array<std::uint64_t, 2> count{};
    for (; end < sides.size() && sides[end].low == sides[first].low &&
           sides[end].high == sides[first].high;
         ++end) {
      ++count[sides[end].is_reversed ? 1 : 0];
    }
    const Side& side = sides[first];
    if (count[0] > 1 || count[1] > 1) {
      faults.shared_edges.add(positions[side.low]);
    } else if (count[0] != count[1]) {
      border.push_back(side.is_reversed ? BorderEdge{side.high, side.low}
                                        : BorderEdge{side.low, side.high});
    }
    first = end;
  }
  std::sort(border.begin(), border.end(), [](const BorderEdge& a, const BorderEdge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  return border;
}

}  // namespace ptin
