// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline_trace.h"

#include <algorithm>
#include <span>
#include <utility>

namespace ptin {

namespace {

constexpr std::size_t kStopInterval = 4096;

class Tracer {
 public:
  Tracer(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
         const AffineMap& map, const TraceScope& scope, const QueryContext& context)
      : tin_(tin),
        levels_(levels),
        heights_(heights),
        map_(map),
        scope_(scope),
        context_(context) {}

  /// Finds the triangles that each level crosses.
  void collect(std::uint64_t fixed_bytes);
  void trace(std::vector<IsolinePiece>& pieces, PointStore& points);
  [[nodiscard]] const TraceCounts& counts() const noexcept { return counts_; }

 private:
  struct Step {
    CutEdge edge;
    MapPoint point;
  };

  [[nodiscard]] bool meets_region(const Triangle& t) const noexcept;
  [[nodiscard]] bool is_in_tile(const Triangle& t) const noexcept;
  void count_crossings();
  [[nodiscard]] bool is_traced(TriangleId t) const noexcept {
    return t != kNone && traced_[t] != 0;
  }
  void sides(const Triangle& t, std::uint32_t level, int& entry, int& exit) const noexcept {
    const bool above[3] = {bands_[t.v[0]] > level, bands_[t.v[1]] > level, bands_[t.v[2]] > level};
    entry = entry_side(above), exit = exit_side(above);
  }
  /// The cut of the edge from `below` to `above`.
  [[nodiscard]] Step cut(VertexId below, VertexId above, std::uint32_t level) const noexcept;
  void trace_from(TriangleId start, std::uint32_t level, bool ring);
  void emit(std::uint32_t level, bool ring, std::vector<IsolinePiece>& pieces, PointStore& points);

  const Tin& tin_;
  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const AffineMap& map_;
  const TraceScope& scope_;
  const QueryContext& context_;
  TraceCounts counts_;
  std::vector<std::uint32_t> bands_;    ///< Beside the vertices.
  std::vector<std::uint8_t> traced_;    ///< Beside the triangles: in scope and crossed.
  std::vector<std::uint64_t> begin_;    ///< Of each level in crossed_; one more at the end.
  std::vector<TriangleId> crossed_;     ///< By level.
  std::vector<std::uint32_t> visited_;  ///< Beside the triangles: 1 + the last level traced there.
  std::vector<Step> steps_;             ///< Of the piece at hand.
  std::vector<MapPoint> line_;
};

bool Tracer::meets_region(const Triangle& t) const noexcept {
  return scope_.region == nullptr ||
         scope_.region->meets(tin_.position(t.v[0]), tin_.position(t.v[1]), tin_.position(t.v[2]));
}

bool Tracer::is_in_tile(const Triangle& t) const noexcept {
  return contains(scope_.tile,
                  point_of(std::min({key_of(tin_.position(t.v[0])), key_of(tin_.position(t.v[1])),
                                     key_of(tin_.position(t.v[2]))})));
}

void Tracer::count_crossings() {
  bands_.resize(tin_.vertices.size());
  for (VertexId v = 0; v < tin_.vertices.size(); ++v) {
    bands_[v] = levels_.band_of(heights_.code(tin_.vertices[v].height));
  }
  std::vector<std::uint8_t> seen(tin_.vertices.size());
  traced_.assign(tin_.triangles.size(), 0);
  begin_.assign(levels_.size() + 1, 0);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context_.check_stop();
    }
    const Triangle& triangle = tin_.triangles[t];
    if (triangle.v[0] == kNone || tin_.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    const auto [low, high] =
        std::minmax({bands_[triangle.v[0]], bands_[triangle.v[1]], bands_[triangle.v[2]]});
    if (low == high || !meets_region(triangle)) {
      continue;
    }
    for (const VertexId v : triangle.v) {
      seen[v] = 1;  // those in the tile are known whole: all triangles around them meet it
    }
    if (!is_in_tile(triangle)) {
      continue;
    }
    traced_[t] = 1;
    ++counts_.triangles;
    counts_.segments += high - low;
    for (std::uint32_t level = low; level < high; ++level) {
      ++begin_[level + 1];
    }
  }
  for (VertexId v = 0; v < seen.size(); ++v) {
    counts_.vertices += seen[v] != 0 && contains(scope_.tile, tin_.position(v)) ? 1 : 0;
  }
}

void Tracer::collect(std::uint64_t fixed_bytes) {
  count_crossings();
  context_.admit(fixed_bytes + tin_.vertices.size() * sizeof(std::uint32_t) +
                 tin_.triangles.size() * (sizeof(std::uint32_t) + 1) +
                 counts_.segments * (sizeof(TriangleId) + sizeof(MapPoint)));
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    begin_[level + 1] += begin_[level];
  }
  crossed_.resize(counts_.segments);
  std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (traced_[t] == 0) {
      continue;
    }
    const Triangle& triangle = tin_.triangles[t];
    const auto [low, high] =
        std::minmax({bands_[triangle.v[0]], bands_[triangle.v[1]], bands_[triangle.v[2]]});
    for (std::uint32_t level = low; level < high; ++level) {
      crossed_[next[level]++] = t;
    }
  }
  visited_.assign(tin_.triangles.size(), 0);
}

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
                  PointStore& points) {
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
  line_.clear();
  for (auto s = steps_.begin(); s != steps_.end(); ++s) {
    if (line_.empty() || line_.back() != s->point) {
      line_.push_back(s->point);
    }
    if (s == smallest) {
      piece.smallest_at = static_cast<std::uint32_t>(line_.size() - 1);
    }
  }
  piece.first = points.size();
  piece.count = static_cast<std::uint32_t>(line_.size());
  points.add(line_);
  pieces.push_back(piece);
}

void Tracer::trace(std::vector<IsolinePiece>& pieces, PointStore& points) {
  for (std::uint32_t level = 0; level < levels_.size(); ++level) {
    context_.check_stop();
    const std::span<const TriangleId> crossed(crossed_.data() + begin_[level],
                                              begin_[level + 1] - begin_[level]);
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

TraceCounts trace_isolines(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                           const AffineMap& map, const TraceScope& scope, std::uint64_t fixed_bytes,
                           const QueryContext& context, std::vector<IsolinePiece>& pieces,
                           PointStore& points) {
  Tracer tracer(tin, levels, heights, map, scope, context);
  tracer.collect(fixed_bytes);
  tracer.trace(pieces, points);
  return tracer.counts();
}

}  // namespace ptin
