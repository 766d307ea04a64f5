// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/tin_surface.h"

#include <cmath>

#include "engine/check.h"
#include "engine/geometry/orient.h"

namespace ptin::oracle {

/// Where the walk stands: at a vertex that the edge passes through, or about to cross an edge of
/// the full TIN.
struct TinSurface::Step {
  VertexId vertex = kNone;      ///< The vertex that the edge passes through, or kNone.
  TriangleId triangle = kNone;  ///< Otherwise: the triangle to leave ...
  int side = 0;                 ///< ... across this side.
};

TinSurface::TinSurface(const Tin& full, const HeightEncoding& encoding)
    : full_(full), encoding_(encoding) {
  for (VertexId v = 0; v < full_.vertices.size(); ++v) {
    vertex_at_.emplace(key_of(full_.position(v)), v);
  }
}

/// From vertex `v` on the segment: the triangle around it into which the segment runs, or the
/// neighbour that it runs through.
TinSurface::Step TinSurface::leave_vertex(VertexId v, GridPoint from, GridPoint to) const {
  const TriangleId start = full_.vertices[v].triangle;
  const auto ahead = [&](VertexId n) {
    const GridPoint p = full_.position(n);
    const std::int64_t dx = std::int64_t{to.x} - from.x;
    const std::int64_t dy = std::int64_t{to.y} - from.y;
    const GridPoint o = full_.position(v);
    const auto along =
        dx * (std::int64_t{p.x} - o.x) + dy * (std::int64_t{p.y} - o.y);  // below 2^61, as orient()
    return along > 0;
  };
  TriangleId t = start;
  do {
    const Triangle& triangle = full_.triangles[t];
    const int c = corner_of(triangle, v);
    const VertexId next = triangle.v[next_corner(c)];
    const VertexId previous = triangle.v[previous_corner(c)];
    const std::int64_t right = orient(from, to, full_.position(next));
    const std::int64_t left = orient(from, to, full_.position(previous));
    if (right == 0 && ahead(next)) {
      return {next, kNone, 0};
    }
    if (left == 0 && ahead(previous)) {
      return {previous, kNone, 0};
    }
    if (right < 0 && left > 0) {
      return {kNone, t, c};
    }
    t = triangle.n[next_corner(c)];
  } while (t != kNone && t != start);
  check_failed("the segment stays inside of the full TIN", __FILE__, __LINE__);
}

/// Past the edge of the full TIN that `step` names: the next edge or vertex on the segment.
TinSurface::Step TinSurface::cross_edge(const Step& step, GridPoint from, GridPoint to) const {
  const TriangleId t = full_.triangles[step.triangle].n[step.side];
  PTIN_CHECK(t != kNone);
  const Triangle& triangle = full_.triangles[t];
  const int entry = side_of(triangle, step.triangle);
  const std::int64_t apex = orient(from, to, full_.position(triangle.v[entry]));
  if (apex == 0) {
    return {triangle.v[entry], kNone, 0};
  }
  // Seen along the segment, corner next(entry) lies to the left and previous(entry) to the right;
  // it leaves across the side between the apex and the corner on the other hand.
  return {kNone, t, apex > 0 ? next_corner(entry) : previous_corner(entry)};
}

double TinSurface::largest_gap(const EdgeEnd& a, const EdgeEnd& b) const {
  GapMaximum gap(a.code);
  const double rise = b.code - a.code;
  const double length_x = static_cast<double>(b.position.x) - a.position.x;
  const double length_y = static_cast<double>(b.position.y) - a.position.y;
  const bool by_x = std::abs(length_x) >= std::abs(length_y);
  const VertexId first = vertex_at_.at(key_of(a.position));
  const VertexId last = vertex_at_.at(key_of(b.position));
  Step step = leave_vertex(first, a.position, b.position);
  while (step.vertex != last) {
    if (step.vertex != kNone) {
      const GridPoint p = full_.position(step.vertex);
      const double t = by_x ? (static_cast<double>(p.x) - a.position.x) / length_x
                            : (static_cast<double>(p.y) - a.position.y) / length_y;
      if (full_.has_height[step.vertex] != 0) {
        gap.add(code(step.vertex), code(step.vertex), 0.0, rise * t);
      }
      step = leave_vertex(step.vertex, a.position, b.position);
      continue;
    }
    const Triangle& triangle = full_.triangles[step.triangle];
    const VertexId p = triangle.v[next_corner(step.side)];
    const VertexId q = triangle.v[previous_corner(step.side)];
    if (is_surface(step.triangle) || is_surface(triangle.n[step.side])) {
      const GridPoint pp = full_.position(p);
      const GridPoint pq = full_.position(q);
      const auto sp = static_cast<double>(orient(a.position, b.position, pp));
      const auto sq = static_cast<double>(orient(a.position, b.position, pq));
      const double f = sp / (sp - sq);
      const auto ta = static_cast<double>(orient(pp, pq, a.position));
      const auto tb = static_cast<double>(orient(pp, pq, b.position));
      gap.add(code(p), code(q), f, rise * (ta / (ta - tb)));
    }
    step = cross_edge(step, a.position, b.position);
  }
  return gap.bound();
}

}  // namespace ptin::oracle
