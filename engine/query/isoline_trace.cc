// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline_trace.h"

#include <algorithm>
#include <span>
#include <utility>

namespace ptin {

namespace {

class Tracer {
 public:
  Tracer(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
         const AffineMap& map, const Crossings& crossings, const QueryContext& context)
      : tin_(tin),
        levels_(levels),
        heights_(heights),
        map_(map),
        crossings_(crossings),
        context_(context),
        visited_(tin.triangles.size()) {}

  void trace(std::vector<IsolinePiece>& pieces, std::vector<MapPoint>& points);

 private:
  struct Step {
    CutEdge edge;
    MapPoint point;
  };

  [[nodiscard]] bool is_traced(TriangleId t) const noexcept {
    return t != kNone && crossings_.traced[t] != 0;
  }
  void sides(const Triangle& t, std::uint32_t level, int& entry, int& exit) const noexcept {
    const std::vector<std::uint32_t>& bands = crossings_.bands;
    const bool above[3] = {bands[t.v[0]] > level, bands[t.v[1]] > level, bands[t.v[2]] > level};
    entry = entry_side(above), exit = exit_side(above);
  }
  /// The cut of the edge from `below` to `above`.
  [[nodiscard]] Step cut(VertexId below, VertexId above, std::uint32_t level) const noexcept;
  void trace_from(TriangleId start, std::uint32_t level, bool ring);
  void emit(std::uint32_t level, bool ring, std::vector<IsolinePiece>& pieces,
            std::vector<MapPoint>& points);

  const Tin& tin_;
  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const AffineMap& map_;
  const Crossings& crossings_;
  const QueryContext& context_;
  std::vector<std::uint32_t> visited_;  ///< Beside the triangles: 1 + the last level traced there.
  std::vector<Step> steps_;             ///< Of the piece at hand.
};

Tracer::Step Tracer::cut(VertexId below, VertexId above, std::uint32_t level) const noexcept {
  const Vertex& b = tin_.vertices[below];
  const Vertex& a = tin_.vertices[above];
  const MapPoint p = cut_of({static_cast<double>(b.position.x), static_cast<double>(b.position.y),
                             heights_.code(b.height)},
                            {static_cast<double>(a.position.x), static_cast<double>(a.position.y),
                             heights_.code(a.height)},
                            levels_.code(level));
  return {{key_of(b.position), key_of(a.position)}, map_.to_map(p.x, p.y)};
}

/// One step for each edge crossed. A ring has no step for the edge that it began with: it comes
/// back to it as the last.
void Tracer::trace_from(TriangleId start, std::uint32_t level, bool ring) {
  steps_.clear();
  TriangleId t = start;
  int entry = 0;
  int exit = 0;
  sides(tin_.triangles[t], level, entry, exit);
  if (!ring) {
    const Triangle& first = tin_.triangles[t];
    steps_.push_back(cut(first.v[next_corner(entry)], first.v[previous_corner(entry)], level));
  }
  do {
    visited_[t] = level + 1;
    const Triangle& triangle = tin_.triangles[t];
    sides(triangle, level, entry, exit);
    steps_.push_back(cut(triangle.v[previous_corner(exit)], triangle.v[next_corner(exit)], level));
    t = triangle.n[exit];
  } while (is_traced(t) && t != start);
}

void Tracer::emit(std::uint32_t level, bool ring, std::vector<IsolinePiece>& pieces,
                  std::vector<MapPoint>& points) {
  auto smallest = std::min_element(steps_.begin(), steps_.end(),
                                   [](const Step& a, const Step& b) { return a.edge < b.edge; });
  IsolinePiece piece;
  piece.level = level;
  piece.ring = ring;
  piece.smallest = smallest->edge;
  if (ring) {
    std::rotate(steps_.begin(), smallest, steps_.end());
    steps_.push_back(steps_.front());
    smallest = steps_.begin();
  } else {
    piece.begin = steps_.front().edge;
    piece.end = steps_.back().edge;
  }
  piece.first = points.size();
  for (auto s = steps_.begin(); s != steps_.end(); ++s) {
    if (points.size() == piece.first || points.back() != s->point) {
      points.push_back(s->point);
    }
    if (s == smallest) {
      piece.smallest_at = static_cast<std::uint32_t>(points.size() - 1 - piece.first);
    }
  }
  piece.count = static_cast<std::uint32_t>(points.size() - piece.first);
  pieces.push_back(piece);
}

void Tracer::trace(std::vector<IsolinePiece>& pieces, std::vector<MapPoint>& points) {
  for (std::uint32_t level = 0; level < levels_.size(); ++level) {
    context_.check_stop();
    const auto crossed = std::span(crossings_.triangles)
                             .subspan(crossings_.begin[level],
                                      crossings_.begin[level + 1] - crossings_.begin[level]);
    for (const bool ring : {false, true}) {  // what is left when all open lines are traced
      for (const TriangleId t : crossed) {
        if (visited_[t] == level + 1) {
          continue;
        }
        int entry = 0;
        int exit = 0;
        sides(tin_.triangles[t], level, entry, exit);
        if (ring || !is_traced(tin_.triangles[t].n[entry])) {
          trace_from(t, level, ring);
          emit(level, ring, pieces, points);
        }
      }
    }
  }
}

}  // namespace

void trace_crossings(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                     const AffineMap& map, const Crossings& crossings, const QueryContext& context,
                     std::vector<IsolinePiece>& pieces, std::vector<MapPoint>& points) {
  Tracer(tin, levels, heights, map, crossings, context).trace(pieces, points);
}

TraceResult trace_isolines(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                           const AffineMap& map, const TraceScope& scope, std::uint64_t most_bytes,
                           const QueryContext& context, std::vector<IsolinePiece>& pieces,
                           std::vector<MapPoint>& points) {
  const FoundCrossings found = find_crossings(tin, levels, heights, scope, most_bytes, context);
  if (found.found) {
    trace_crossings(tin, levels, heights, map, found.crossings, context, pieces, points);
  }
  return {found.found, found.bytes, found.counts};
}

}  // namespace ptin
