// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/walk/walk.h"

#include <algorithm>
#include <utility>

namespace ptin {

namespace {

/// Puts the vertices of a footing into ascending order of their keys.
void sort_by_key(const Tin& tin, Footing& f) {
  const auto order = [&](std::size_t i, std::size_t j) {
    if (key_of(tin.position(f.vertex[j])) < key_of(tin.position(f.vertex[i]))) {
      std::swap(f.vertex[i], f.vertex[j]);
      std::swap(f.weight[i], f.weight[j]);
    }
  };
  if (f.count > 1) {
    order(0, 1);
  }
  if (f.count == 3) {
    order(1, 2);
    order(0, 1);
  }
}

Footing on_vertex(VertexId v) { return {1, {v, kNone, kNone}, {1, 0, 0}}; }

Int128 magnitude(Int128 v) noexcept { return v < 0 ? -v : v; }

/// What find_spot() found out about one triangle.
struct Look {
  int beyond = -1;  ///< A side that has the spot strictly beyond it; -1: none.
  int zeros = 0;    ///< Sides on whose line the spot lies, one bit each.
};

Look look_at(const Tin& tin, const Triangle& t, Spot q, int first, TriangleId from) {
  Look look;
  for (int k = 0; k < 3; ++k) {
    // Beyond two sides `first` decides: without chance a walk could go round in circles.
    const int i = (first + k) % 3;
    if (from != kNone && t.n[i] == from) {
      continue;  // crossed just now: the spot lies strictly on this side of it
    }
    const Int128 s =
        side(tin.position(t.v[next_corner(i)]), tin.position(t.v[previous_corner(i)]), q);
    if (s < 0) {
      look.beyond = i;
      return look;
    }
    look.zeros |= s == 0 ? 1 << i : 0;
  }
  return look;
}

Place inside(TriangleId t, int zeros) {
  switch (zeros) {
    case 0:
      return {Lies::kInTriangle, t, 0};
    case 1:
      return {Lies::kOnEdge, t, 0};
    case 2:
      return {Lies::kOnEdge, t, 1};
    case 4:
      return {Lies::kOnEdge, t, 2};
    default:  // on two sides: on the corner that both share, opposite to the third side
      return {Lies::kOnVertex, t, zeros == 6 ? 0 : (zeros == 5 ? 1 : 2)};
  }
}

/// The corners' keys, ascending.
std::array<VertexKey, 3> keys_of(const Tin& tin, TriangleId t) {
  std::array<VertexKey, 3> keys{};
  for (std::size_t i = 0; i < 3; ++i) {
    keys[i] = key_of(tin.position(tin.triangles[t].v[i]));
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

/// True when `a` answers rather than `b`.
bool is_preferred(const Tin& tin, TriangleId a, TriangleId b) {
  if (tin.classes[a] != tin.classes[b]) {
    return tin.classes[a] == TriangleClass::kSurface;
  }
  return keys_of(tin, a) < keys_of(tin, b);
}

/// Calls `visit` with each triangle around `v`, counter-clockwise; stops when it returns false.
template <typename Visit>
void around_vertex(const Tin& tin, VertexId v, const Visit& visit) {
  const TriangleId first = tin.vertices[v].triangle;
  TriangleId t = first;
  do {
    const Triangle& triangle = tin.triangles[t];
    const int corner = corner_of(triangle, v);
    if (!visit(t, corner)) {
      return;
    }
    t = triangle.n[next_corner(corner)];
  } while (t != kNone && t != first);
}

bool touches(const Tin& tin, VertexId v, TriangleClass wanted) {
  bool touches = false;
  around_vertex(tin, v, [&](TriangleId t, int /*corner*/) {
    touches = tin.classes[t] == wanted;
    return !touches;
  });
  return touches;
}

}  // namespace

Place find_spot(const Tin& tin, Spot q, TriangleId start) {
  TriangleId t = start;
  TriangleId from = kNone;
  std::uint32_t chance = 1;
  for (std::size_t steps = 0; steps <= tin.triangles.size(); ++steps) {
    // Numerical Recipes' generator; its low bits repeat soon, so only high ones are used.
    chance = chance * 1664525U + 1013904223U;
    const Triangle& triangle = tin.triangles[t];
    const Look look = look_at(tin, triangle, q, static_cast<int>((chance >> 24) % 3), from);
    if (look.beyond < 0) {
      return inside(t, look.zeros);
    }
    if (triangle.n[look.beyond] == kNone) {
      return {Lies::kOutside, t, look.beyond};  // beyond a side of a convex domain
    }
    from = t;
    t = triangle.n[look.beyond];
  }
  // A dead triangle counts as having the spot beyond it.
  for (t = 0; t < tin.triangles.size(); ++t) {
    const Look look = tin.is_alive(t) ? look_at(tin, tin.triangles[t], q, 0, kNone) : Look{0, 0};
    if (look.beyond < 0) {
      return inside(t, look.zeros);
    }
    if (tin.is_alive(t) && tin.triangles[t].n[look.beyond] == kNone) {
      return {Lies::kOutside, t, look.beyond};
    }
  }
  return {};
}

TriangleId answering_triangle(const Tin& tin, const Place& place) {
  if (place.lies == Lies::kOutside) {
    return kNone;
  }
  TriangleId best = place.triangle;
  const Triangle& triangle = tin.triangles[best];
  if (place.lies == Lies::kOnEdge) {
    const TriangleId other = triangle.n[place.index];
    return other != kNone && is_preferred(tin, other, best) ? other : best;
  }
  if (place.lies == Lies::kOnVertex) {
    around_vertex(tin, triangle.v[place.index], [&](TriangleId t, int /*corner*/) {
      best = t != best && is_preferred(tin, t, best) ? t : best;
      return true;
    });
  }
  return best;
}

bool touches_surface(const Tin& tin, VertexId v) {
  return touches(tin, v, TriangleClass::kSurface);
}

bool touches_void(const Tin& tin, VertexId v) { return touches(tin, v, TriangleClass::kVoid); }

Footing footing_of(const Tin& tin, Spot q, const Place& place) {
  const Triangle& t = tin.triangles[place.triangle];
  if (place.lies == Lies::kOnVertex) {
    return on_vertex(t.v[place.index]);
  }
  Footing f;
  for (int i = 0; i < 3; ++i) {
    const Int128 weight =
        side(tin.position(t.v[next_corner(i)]), tin.position(t.v[previous_corner(i)]), q);
    // On an edge the corner opposite is left out: both its triangles name the same two vertices.
    if (weight != 0) {
      f.vertex[static_cast<std::size_t>(f.count)] = t.v[i];
      f.weight[static_cast<std::size_t>(f.count)] = weight;
      ++f.count;
    }
  }
  sort_by_key(tin, f);
  if (f.count == 2) {
    const auto [a, b] = edge_weights(tin.position(f.vertex[0]), tin.position(f.vertex[1]), q);
    f.weight = {a, b, 0};
  }
  return f;
}

/// Computes z0 + sum w_i (z_i - z0) / W, where W is the sum of the weights. Bound, with u = 2^-53:
/// differences, quotients of exact sums and products carry 4u of |z_i - z0|, which is at most
/// 2 max |z|. The weights sum to at most W, so 8u max |z| covers the products. Each sum adds u of a
/// value that is at most max |z| after the clamp.
double weighted_mean(int count, const std::array<double, 3>& z,
                     const std::array<Int128, 3>& weight) {
  if (count == 1) {
    return z[0];
  }
  if (count == 2) {
    // Differences are weighed, not heights, so equal heights give exactly that height.
    const double mean = z[0] + (z[1] - z[0]) * (static_cast<double>(weight[1]) /
                                                static_cast<double>(weight[0] + weight[1]));
    return std::clamp(mean, std::min(z[0], z[1]), std::max(z[0], z[1]));
  }
  const auto whole = static_cast<double>(weight[0] + weight[1] + weight[2]);
  const double mean = z[0] + (z[1] - z[0]) * (static_cast<double>(weight[1]) / whole) +
                      (z[2] - z[0]) * (static_cast<double>(weight[2]) / whole);
  return std::clamp(mean, std::min({z[0], z[1], z[2]}), std::max({z[0], z[1], z[2]}));
}

WeightedCodes codes_at(const Tin& tin, const HeightEncoding& heights, const Footing& f) {
  WeightedCodes codes{f.count, {}, f.weight};
  for (int i = 0; i < f.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    codes.code[k] = heights.code(tin.vertices[f.vertex[k]].height);
  }
  return codes;
}

LineWalk::LineWalk(const Tin& tin, Spot p, Spot q, TriangleId start) : tin_(&tin), p_(p), q_(q) {
  const Place place = find_spot(tin, p, start);
  begins_inside_ = place.lies != Lies::kOutside;
  if (begins_inside_) {
    meets_ = true;
    entry_.footing = footing_of(tin, p, place);
    begin_at(place);
  } else {
    begin_outside(place);
  }
}

void LineWalk::begin_at(const Place& place) {
  triangle_ = place.triangle;
  if (place.lies == Lies::kInTriangle) {
    state_ = State::kInTriangle;
  } else if (place.lies == Lies::kOnVertex) {
    state_ = State::kAtVertex;
    vertex_ = tin_->triangles[place.triangle].v[place.index];
  } else {
    begin_on_edge(place.triangle, place.index);
  }
}

/// p lies in an edge: the line goes along it, or into the triangle on one side of it.
void LineWalk::begin_on_edge(TriangleId t, int edge_side) {
  const Triangle& triangle = tin_->triangles[t];
  const VertexId a = triangle.v[next_corner(edge_side)];
  const VertexId b = triangle.v[previous_corner(edge_side)];
  const Int128 turn_a = turn(a);
  if (turn_a == 0) {
    // p lies strictly between a and b, so one axis on which the line moves shows which is ahead.
    const Spot ahead = spot_of(tin_->position(b));
    const bool to_b =
        q_.x != p_.x ? (q_.x > p_.x) == (ahead.x > p_.x) : (q_.y > p_.y) == (ahead.y > p_.y);
    state_ = State::kAlongEdge;
    vertex_ = to_b ? b : a;
    triangle_ = t;
    beside_ = triangle.n[edge_side];
    return;
  }
  if (turn_a > 0) {  // a to the left, b to the right: the line enters t
    enter_through(t, edge_side);
  } else if (const TriangleId other = triangle.n[edge_side]; other != kNone) {
    enter_through(other, side_of(tin_->triangles[other], t));
  }
}

/// Prepares the crossing of `t`, entered through a side whose first end lies to the left of the
/// line.
void LineWalk::enter_through(TriangleId t, int edge_side) {
  const Triangle& triangle = tin_->triangles[t];
  state_ = State::kIntoEdge;
  triangle_ = t;
  side_ = edge_side;
  left_turn_ = turn(triangle.v[next_corner(edge_side)]);
  right_turn_ = turn(triangle.v[previous_corner(edge_side)]);
}

/// Finds the border edge through which the line comes in, among those that p sees. Goes round the
/// whole border, since only a test of each edge shows whether p sees it.
void LineWalk::begin_outside(const Place& place) {
  TriangleId t = place.triangle;
  int edge_side = place.index;
  const VertexId first = tin_->triangles[t].v[next_corner(edge_side)];
  VertexId a = first;
  do {
    const VertexId b = tin_->triangles[t].v[previous_corner(edge_side)];
    // The line comes in over an edge that has p beyond it. A vertex behind p or q decides nothing.
    if (side(tin_->position(a), tin_->position(b), p_) < 0) {
      const Int128 turn_a = turn(a);
      const Int128 turn_b = turn(b);
      const VertexId hit = turn_a == 0 ? a : (turn_b == 0 ? b : kNone);
      if (hit != kNone && lies_ahead(tin_->position(hit)) &&
          compare_with_end(tin_->position(hit)) <= 0) {
        meets_ = true;
        entry_ = at_vertex(hit);
        state_ = State::kAtVertex;
        vertex_ = hit;
        return;
      }
      // A convex border lets a line in over one edge, so q decides whether it comes so far.
      if (turn_a > 0 && turn_b < 0) {
        const Int128 end = side(tin_->position(a), tin_->position(b), q_);
        meets_ = end >= 0;
        if (meets_) {
          entry_ = at_edge(b, a, turn_b, turn_a);
          enter_through(t, edge_side);
        }
        return;
      }
    }
    a = b;
    // A vertex of the border names the first of its triangles: its border edge begins at b.
    t = tin_->vertices[b].triangle;
    edge_side = previous_corner(corner_of(tin_->triangles[t], b));
  } while (a != first);
}

bool LineWalk::next() {
  piece_.from = piece_.triangle == kNone ? entry_ : piece_.to;
  piece_.other = kNone;
  // A share is an exact fraction, so the end of the line is known without a tolerance.
  const bool at_end = meets_ && piece_.from.numerator == piece_.from.denominator;
  ends_inside_ = ends_inside_ || at_end;
  if (!meets_ || at_end || state_ == State::kDone) {
    state_ = State::kDone;
    return false;
  }
  switch (state_) {
    case State::kInTriangle:
      leave_triangle(triangle_);
      return true;
    case State::kIntoEdge:
      cross_triangle();
      return true;
    case State::kAtVertex:
      return step_from_vertex();
    case State::kAlongEdge:
      step_along_edge();
      return true;
    case State::kDone:
      break;
  }
  return false;
}

/// From the inside of a triangle: the line leaves by the edge whose first end lies to its right and
/// whose second end to its left, or by the vertex between two such edges.
void LineWalk::leave_triangle(TriangleId t) {
  const Triangle& triangle = tin_->triangles[t];
  const Int128 turns[3] = {turn(triangle.v[0]), turn(triangle.v[1]), turn(triangle.v[2])};
  for (int i = 0; i < 3; ++i) {
    const int j = next_corner(i);
    // p is strictly inside, so exactly one side, or one corner, has the line go out.
    if (turns[i] < 0 && turns[j] > 0) {
      exit_by_edge(t, previous_corner(i), turns[i], turns[j]);
      return;
    }
    if (turns[i] < 0 && turns[j] == 0) {
      exit_by_vertex(t, triangle.v[j]);
      return;
    }
  }
}

/// Crosses triangle_ from side_, whose first end lies to the left of the line and whose second end
/// to the right.
void LineWalk::cross_triangle() {
  const TriangleId t = triangle_;
  const VertexId apex = tin_->triangles[t].v[side_];
  const Int128 apex_turn = turn(apex);
  if (apex_turn == 0) {
    exit_by_vertex(t, apex);
  } else if (apex_turn > 0) {  // between the right end and the apex
    exit_by_edge(t, next_corner(side_), right_turn_, apex_turn);
  } else {
    exit_by_edge(t, previous_corner(side_), apex_turn, left_turn_);
  }
}

void LineWalk::exit_by_edge(TriangleId t, int edge_side, Int128 right, Int128 left) {
  const Triangle& triangle = tin_->triangles[t];
  const VertexId a = triangle.v[next_corner(edge_side)];
  const VertexId b = triangle.v[previous_corner(edge_side)];
  piece_.triangle = t;
  // The line stays in t up to this edge: if q lies before the edge, it lies in t.
  const Int128 end = side(tin_->position(a), tin_->position(b), q_);
  if (end > 0) {
    end_at(footing_of(*tin_, q_, {Lies::kInTriangle, t, 0}));
    return;
  }
  piece_.to = at_edge(a, b, right, left);
  const TriangleId beyond = triangle.n[edge_side];
  // The domain is convex: a line that leaves it does not come back.
  if (end == 0 || beyond == kNone) {
    ends_inside_ = end == 0;
    state_ = State::kDone;
    return;
  }
  state_ = State::kIntoEdge;
  triangle_ = beyond;
  side_ = side_of(tin_->triangles[beyond], t);
  // The ends of the edge keep their turns, so the next triangle asks for that of its apex alone.
  right_turn_ = right;
  left_turn_ = left;
}

void LineWalk::exit_by_vertex(TriangleId t, VertexId v) {
  piece_.triangle = t;
  if (compare_with_end(tin_->position(v)) > 0) {
    end_at(footing_of(*tin_, q_, {Lies::kInTriangle, t, 0}));
    return;
  }
  piece_.to = at_vertex(v);
  state_ = State::kAtVertex;
  vertex_ = v;
}

/// Goes along an edge whose other end lies on the line ahead, or into the triangle that the line
/// cuts. Returns false when there is neither: the line leaves the domain.
bool LineWalk::step_from_vertex() {
  bool stepped = false;
  around_vertex(*tin_, vertex_, [&](TriangleId t, int corner) {
    const Triangle& triangle = tin_->triangles[t];
    const VertexId a = triangle.v[next_corner(corner)];
    const VertexId b = triangle.v[previous_corner(corner)];
    const Int128 turn_a = turn(a);
    const Int128 turn_b = turn(b);
    // A corner on the line lies ahead when the third one is on the triangle's side of it.
    if ((turn_a == 0 && turn_b > 0) || (turn_b == 0 && turn_a < 0)) {
      vertex_ = turn_a == 0 ? a : b;
      triangle_ = t;
      beside_ = triangle.n[turn_a == 0 ? previous_corner(corner) : next_corner(corner)];
      step_along_edge();
      stepped = true;
    } else if (turn_a < 0 && turn_b > 0) {
      exit_by_edge(t, corner, turn_a, turn_b);
      stepped = true;
    }
    return !stepped;
  });
  state_ = stepped ? state_ : State::kDone;
  return stepped;
}

void LineWalk::step_along_edge() {
  piece_.triangle = triangle_;
  piece_.other = beside_;
  if (compare_with_end(tin_->position(vertex_)) > 0) {
    // No side is named: footing_of() finds it by its weight of 0.
    end_at(footing_of(*tin_, q_, {Lies::kOnEdge, triangle_, 0}));
    return;
  }
  piece_.to = at_vertex(vertex_);
  state_ = State::kAtVertex;
}

void LineWalk::end_at(const Footing& footing) {
  piece_.to = {footing, 1, 1};
  ends_inside_ = true;
  state_ = State::kDone;
}

/// Whether a vertex on the line lies ahead of p.
bool LineWalk::lies_ahead(GridPoint v) const noexcept {
  const Spot at = spot_of(v);
  return q_.x != p_.x ? at.x != p_.x && (q_.x > p_.x) == (at.x > p_.x)
                      : at.y != p_.y && (q_.y > p_.y) == (at.y > p_.y);
}

/// Whether a vertex on the line, ahead of p, lies before q (-1), on it (0) or beyond it (1).
int LineWalk::compare_with_end(GridPoint v) const noexcept {
  const Spot at = spot_of(v);
  const std::int64_t whole_x = q_.x - p_.x;
  const std::int64_t beyond = whole_x != 0 ? (whole_x > 0 ? at.x - q_.x : q_.x - at.x)
                                           : (q_.y > p_.y ? at.y - q_.y : q_.y - at.y);
  return beyond < 0 ? -1 : (beyond > 0 ? 1 : 0);
}

Crossing LineWalk::at_vertex(VertexId v) const {
  const Spot at = spot_of(tin_->position(v));
  const std::int64_t dx = q_.x - p_.x;
  const std::int64_t dy = q_.y - p_.y;
  // The vertex is on the line, so both axes give the same fraction; the larger one is never 0 / 0.
  const bool by_x = (dx < 0 ? -dx : dx) >= (dy < 0 ? -dy : dy);
  return {on_vertex(v), magnitude(by_x ? at.x - p_.x : at.y - p_.y), magnitude(by_x ? dx : dy)};
}

Crossing LineWalk::at_edge(VertexId right, VertexId left, Int128 right_turn,
                           Int128 left_turn) const {
  Crossing c;
  // An end weighs as much as the other end is away from the line.
  c.footing = {2, {right, left, kNone}, {magnitude(left_turn), magnitude(right_turn), 0}};
  sort_by_key(*tin_, c.footing);
  const GridPoint a = tin_->position(right);
  const GridPoint b = tin_->position(left);
  // p and q lie on either side of the edge, so their distances to it add up to the whole way.
  c.numerator = magnitude(side(a, b, p_));
  c.denominator = c.numerator + magnitude(side(a, b, q_));
  return c;
}

}  // namespace ptin
