// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/part_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/construct/tile/witnessed_triangle.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/orient.h"

namespace ptin {

/// Where the walk stands: at a vertex that the edge passes through, about to leave a triangle, or
/// at the end.
struct PartSurface::Step {
  VertexId vertex = kNone;      ///< The vertex that the edge passes through, or kNone.
  TriangleId triangle = kNone;  ///< Else the triangle that it leaves; kNone: the walk ends here.
  int side = 0;                 ///< The side across which it leaves that triangle.
  [[nodiscard]] bool is_end() const noexcept { return vertex == kNone && triangle == kNone; }
};

/// One edge on its way over the part, piece by piece. Reports to `visitor` where it goes:
/// - touch(v): through this vertex;
/// - cross(t, side): over this side of a triangle;
/// - through(t): through the inside of this triangle.
template <class Visitor>
class PartSurface::Walk {
 public:
  Walk(const PartSurface& surface, GridPoint a, GridPoint b, Visitor& visitor)
      : s_(surface), tin_(surface.part_), a_(a), b_(b), visitor_(visitor) {}

  /// Walks from a vertex on the edge.
  /// @param start  The first of the triangles around it.
  void from_vertex(VertexId v, TriangleId start) { go(leave_vertex(v, start)); }
  /// Walks into the part over a side of its border.
  void from_side(const BorderSide& border) {
    visitor_.cross(border.triangle, border.side);
    visitor_.through(border.triangle);
    go(into(border.triangle, border.side));
  }
  void touch(VertexId v) { visitor_.touch(v); }

 private:
  [[nodiscard]] std::int64_t side_of_edge(VertexId v) const noexcept {
    return orient(a_, b_, tin_.position(v));
  }
  [[nodiscard]] bool is_ahead(VertexId from, VertexId to) const noexcept {
    const GridPoint o = tin_.position(from), p = tin_.position(to);
    return (std::int64_t{b_.x} - a_.x) * (std::int64_t{p.x} - o.x) +
               (std::int64_t{b_.y} - a_.y) * (std::int64_t{p.y} - o.y) >
           0;  // below 2^61, as orient()
  }
  [[nodiscard]] Step leave_vertex(VertexId v, TriangleId start);
  [[nodiscard]] Step into(TriangleId t, int entry) const;
  void go(Step step);

  const PartSurface& s_;
  const Tin& tin_;
  GridPoint a_, b_;
  Visitor& visitor_;
};

/// Takes the largest gap between an edge and the part.
class PartSurface::GapVisitor {
 public:
  GapVisitor(const PartSurface& surface, const EdgeEnd& a, const EdgeEnd& b)
      : s_(surface),
        tin_(surface.part_),
        a_(a),
        b_(b),
        rise_(b.code - a.code),
        length_x_(static_cast<double>(b.position.x) - a.position.x),
        length_y_(static_cast<double>(b.position.y) - a.position.y),
        gap_(a.code) {}

  void touch(VertexId v) {
    if (tin_.has_height[v] == 0) {
      return;
    }
    const GridPoint p = tin_.position(v);
    const double t = std::abs(length_x_) >= std::abs(length_y_)
                         ? (static_cast<double>(p.x) - a_.position.x) / length_x_
                         : (static_cast<double>(p.y) - a_.position.y) / length_y_;
    gap_.add(code(v), code(v), 0.0, rise_ * t);
  }
  void cross(TriangleId t, int side) {
    const Triangle& triangle = tin_.triangles[t];
    if (!is_surface(t) && !is_surface(triangle.n[side])) {
      return;
    }
    const VertexId p = triangle.v[next_corner(side)], q = triangle.v[previous_corner(side)];
    const GridPoint pp = tin_.position(p), pq = tin_.position(q);
    const auto sp = static_cast<double>(orient(a_.position, b_.position, pp));
    const auto sq = static_cast<double>(orient(a_.position, b_.position, pq));
    const auto ta = static_cast<double>(orient(pp, pq, a_.position));
    const auto tb = static_cast<double>(orient(pp, pq, b_.position));
    gap_.add(code(p), code(q), sp / (sp - sq), rise_ * (ta / (ta - tb)));
  }
  void through(TriangleId) noexcept {}
  [[nodiscard]] double bound() const noexcept { return gap_.bound(); }

 private:
  [[nodiscard]] double code(VertexId v) const noexcept {
    return s_.encoding_.code(tin_.vertices[v].height);
  }
  [[nodiscard]] bool is_surface(TriangleId t) const noexcept {
    return t != kNone && tin_.classes[t] == TriangleClass::kSurface;
  }
  const PartSurface& s_;
  const Tin& tin_;
  const EdgeEnd &a_, &b_;
  double rise_, length_x_, length_y_;
  GapMaximum gap_;
};

/// Takes how far the border moves where an edge comes to be a part of it.
class PartSurface::BorderVisitor {
 public:
  BorderVisitor(const PartSurface& surface, GridPoint a, GridPoint b)
      : border_(*surface.void_border_),
        part_{surface.part_, border_.goes_on, {}, border_.step},
        a_(a),
        b_(b) {}

  void touch(VertexId v) {
    moved_ = std::max(moved_, static_cast<double>(border_.witnesses.reach[v]));
  }
  void cross(TriangleId, int) noexcept {}
  void through(TriangleId t) {
    const WitnessedTriangle triangle = witnessed_triangle(part_, border_.witnesses, t);
    moved_ = std::max(moved_, border_crossing(triangle, a_, b_, border_.step));
  }
  [[nodiscard]] double moved() const noexcept { return moved_; }

 private:
  const PartBorder& border_;
  PartOfTerrain part_;
  GridPoint a_, b_;
  double moved_ = 0.0;
};

/// Where the edge goes on from vertex `v`: to a neighbour that it passes through, or into one of
/// the triangles around `v`, of which `start` is the first.
template <class Visitor>
PartSurface::Step PartSurface::Walk<Visitor>::leave_vertex(VertexId v, TriangleId start) {
  TriangleId t = start;
  do {
    const Triangle& triangle = tin_.triangles[t];
    const int c = corner_of(triangle, v);
    const VertexId next = triangle.v[next_corner(c)], previous = triangle.v[previous_corner(c)];
    const std::int64_t right = side_of_edge(next), left = side_of_edge(previous);
    if (right == 0 && is_ahead(v, next)) {
      return {next, kNone, 0};
    }
    if (left == 0 && is_ahead(v, previous)) {
      return {previous, kNone, 0};
    }
    if (right < 0 && left > 0) {
      visitor_.through(t);
      return {kNone, t, c};
    }
    t = triangle.n[next_corner(c)];
  } while (t != kNone && t != start);
  return {};
}

/// Where the edge, which entered triangle `t` over side `entry`, leaves it: a vertex or a side.
template <class Visitor>
PartSurface::Step PartSurface::Walk<Visitor>::into(TriangleId t, int entry) const {
  const VertexId apex = tin_.triangles[t].v[entry];
  const std::int64_t side = side_of_edge(apex);
  if (side == 0) {
    return {apex, kNone, 0};
  }
  // Seen along the edge, corner next(entry) lies to the left and previous(entry) to the right. An
  // apex on the left is left behind on that side, so the edge leaves between the apex and the
  // corner on the right; with an apex on the right it is the other way round.
  return {kNone, t, side > 0 ? next_corner(entry) : previous_corner(entry)};
}

/// Goes on to the end of the edge, or to where it leaves the part. A vertex of the border ends the
/// walk too: walk_over() begins another walk there.
template <class Visitor>
void PartSurface::Walk<Visitor>::go(Step step) {
  while (!step.is_end()) {
    if (step.vertex != kNone) {
      const VertexId v = step.vertex;
      if (s_.on_border_[v] != 0 || tin_.position(v) == b_) {
        return;
      }
      visitor_.touch(v);
      step = leave_vertex(v, tin_.vertices[v].triangle);
      continue;
    }
    visitor_.cross(step.triangle, step.side);
    const TriangleId beyond = tin_.triangles[step.triangle].n[step.side];
    if (beyond == kNone) {
      return;
    }
    visitor_.through(beyond);
    step = into(beyond, side_of(tin_.triangles[beyond], step.triangle));
  }
}

PartSurface::PartSurface(const Tin& part, const HeightEncoding& encoding,
                         std::optional<PartBorder> border, FixedGaps fixed)
    : part_(part),
      encoding_(encoding),
      void_border_(std::move(border)),
      on_border_(part.vertices.size(), 0),
      fixed_(std::move(fixed)) {
  for (TriangleId t = 0; t < part_.triangles.size(); ++t) {
    const Triangle& triangle = part_.triangles[t];
    for (int i = 0; i < 3; ++i) {
      if (triangle.n[i] == kNone) {
        border_.push_back({triangle.v[next_corner(i)], triangle.v[previous_corner(i)], t, i});
        on_border_[border_.back().first] = on_border_[border_.back().second] = 1;
      }
    }
  }
  std::sort(border_.begin(), border_.end(), [](const BorderSide& a, const BorderSide& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  index_border();
}

void PartSurface::index_border() {
  const auto place = [&](std::uint32_t i) {
    const GridPoint p = part_.position(border_[i].first);
    return hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
  };
  by_place_.resize(border_.size());
  std::iota(by_place_.begin(), by_place_.end(), 0U);
  std::sort(by_place_.begin(), by_place_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint64_t pa = place(a), pb = place(b);
    return pa != pb ? pa < pb : a < b;
  });
  std::vector<GridBox> boxes;
  for (const std::uint32_t i : by_place_) {
    boxes.push_back(
        united(box_of(part_.position(border_[i].first)), part_.position(border_[i].second)));
  }
  boxes_ = PackedBoxes(std::move(boxes));
}

VertexId PartSurface::vertex_at(GridPoint p) const noexcept {
  const auto found =
      std::lower_bound(part_.vertices.begin(), part_.vertices.end(), key_of(p),
                       [](const Vertex& v, VertexKey key) { return key_of(v.position) < key; });
  return found != part_.vertices.end() && found->position == p
             ? static_cast<VertexId>(found - part_.vertices.begin())
             : kNone;
}

/// Calls visit(side) for each side of the border whose box the edge may meet.
template <class Visit>
void PartSurface::visit_border(GridPoint a, GridPoint b, const Visit& visit) const {
  const GridBox around = united(box_of(a), b);
  const auto may_meet = [&](const GridBox& box) {
    if (!meets(box, around)) {
      return false;
    }
    int left = 0, right = 0;
    for (const GridPoint p : {GridPoint{box.min_x, box.min_y}, GridPoint{box.max_x, box.min_y},
                              GridPoint{box.min_x, box.max_y}, GridPoint{box.max_x, box.max_y}}) {
      const std::int64_t side = orient(a, b, p);
      left += side > 0 ? 1 : 0;
      right += side < 0 ? 1 : 0;
    }
    return left < 4 && right < 4;
  };
  boxes_.visit(may_meet, [&](std::size_t i) { visit(border_[by_place_[i]]); });
}

template <class Visitor>
void PartSurface::walk_over(GridPoint a, GridPoint b, Visitor& visitor) const {
  Walk<Visitor> walk(*this, a, b, visitor);
  const VertexId begin = vertex_at(a);
  if (begin != kNone && on_border_[begin] == 0) {
    walk.from_vertex(begin, part_.vertices[begin].triangle);
  }
  visit_border(a, b, [&](const BorderSide& side) {
    const GridPoint p = part_.position(side.first), q = part_.position(side.second);
    if (p == b) {
      return;
    }
    const std::int64_t at_p = orient(a, b, p);
    if (at_p == 0) {
      if (contains(united(box_of(a), b), p)) {
        if (p != a) {
          walk.touch(side.first);
        }
        walk.from_vertex(side.first, side.triangle);
      }
      return;
    }
    // The edge comes in where it crosses the side from its right: then p is on the edge's left.
    if (at_p > 0 && orient(a, b, q) < 0 && orient(p, q, a) < 0 && orient(p, q, b) > 0) {
      walk.from_side(side);
    }
  });
}

double PartSurface::largest_gap(const EdgeEnd& a, const EdgeEnd& b) const {
  GapVisitor gap(*this, a, b);
  walk_over(a.position, b.position, gap);
  return gap.bound();
}

double PartSurface::border_move(GridPoint a, GridPoint b) const {
  if (!void_border_) {
    return 0.0;
  }
  BorderVisitor border(*this, a, b);
  for (const GridPoint end : {a, b}) {
    if (const VertexId v = vertex_at(end); v != kNone) {
      border.touch(v);
    }
  }
  walk_over(a, b, border);
  return border.moved();
}

}  // namespace ptin
