// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_trace.h"

#include <algorithm>
#include <span>
#include <utility>

namespace ptin {

namespace {

class Tracer {
 public:
  Tracer(const TraceSource& source, const Crossings& crossings, const QueryContext& context)
      : tin_(source.tin),
        levels_(source.levels),
        heights_(source.heights),
        map_(source.map),
        crossings_(crossings),
        context_(context),
        visited_(source.tin.triangles.size()) {}

  void trace(TracedPieces& out);

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
  void emit(std::uint32_t level, bool ring, TracedPieces& out);

  const Tin& tin_;
  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const AffineMap& map_;
  const Crossings& crossings_;
  const QueryContext& context_;
  std::vector<std::uint32_t> visited_;  ///< For each triangle 1 + the last level traced there.
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

/// Takes the piece that begins in `start`, one step for each edge crossed. A ring has no step for
/// the edge by which it enters `start`: it comes back to that edge last.
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

void Tracer::emit(std::uint32_t level, bool ring, TracedPieces& out) {
  std::vector<MapPoint>& points = out.points;
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
  out.pieces.push_back(piece);
}

void Tracer::trace(TracedPieces& out) {
  for (std::uint32_t level = 0; level < levels_.size(); ++level) {
    context_.check_stop();
    const auto crossed = std::span(crossings_.triangles)
                             .subspan(crossings_.begin[level],
                                      crossings_.begin[level + 1] - crossings_.begin[level]);
    // Rings are what is left once all open lines are traced.
    for (const bool ring : {false, true}) {
      for (const TriangleId t : crossed) {
        if (visited_[t] == level + 1) {
          continue;
        }
        int entry = 0;
        int exit = 0;
        sides(tin_.triangles[t], level, entry, exit);
        if (ring || !is_traced(tin_.triangles[t].n[entry])) {
          trace_from(t, level, ring);
          emit(level, ring, out);
        }
      }
    }
  }
}

}  // namespace

void trace_crossings(const TraceSource& source, const Crossings& crossings,
                     const QueryContext& context, TracedPieces& out) {
  Tracer(source, crossings, context).trace(out);
}

TraceResult trace_isolines(const TraceSource& source, const TraceScope& scope,
                           std::uint64_t most_bytes, const QueryContext& context,
                           TracedPieces& out) {
  const FoundCrossings found =
      find_crossings(source.tin, source.levels, source.heights, scope, most_bytes, context);
  if (found.found) {
    trace_crossings(source, found.crossings, context, out);
  }
  return {found.found, found.bytes, found.counts};
}

}  // namespace ptin
