// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_view.h"

#include <algorithm>

namespace ptin {

namespace {

LinePoint line_point_of(const Tin& tin, const HeightEncoding& heights, const Crossing& c) {
  return {codes_at(tin, heights, c.footing), c.numerator, c.denominator};
}

bool is_surface(const Tin& tin, TriangleId t) {
  return t != kNone && tin.classes[t] == TriangleClass::kSurface;
}

}  // namespace

void SightView::look(const BoundedSurface& mesh) {
  pieces.clear();
  LineWalk walk(mesh.tin(), p(), q(), start_);
  a.inside = walk.begins_inside();
  Crossing last = walk.entry();
  TriangleId last_triangle = kNone;
  while (walk.next()) {
    const LinePiece& piece = walk.piece();
    add_piece(mesh, piece);
    last = piece.to;
    if (last_triangle == kNone) {
      start_ = piece.triangle;
      if (a.inside) {
        set_end(mesh, piece.from, piece.triangle, a);
      }
    }
    last_triangle = piece.triangle;
  }
  b.inside = walk.ends_inside();
  if (b.inside && last_triangle != kNone) {
    set_end(mesh, last, last_triangle, b);
  }
  open_touch_.reset();
  if (pieces.empty() && walk.meets_domain()) {
    set_only_point(mesh, walk);
  }
  take_levels();
  std::for_each(pieces.begin(), pieces.end(), [&](SightPiece& p) { decide_by_bounds(p); });
  decide_exactly_all(mesh);
}

/// Looks at a line that meets the domain in one point alone: an end on the border from where the
/// line stays outside, or a corner of the domain that the line touches.
void SightView::set_only_point(const BoundedSurface& mesh, const LineWalk& walk) {
  for (SightEnd* end : {&a, &b}) {
    if (end->inside) {
      set_end(mesh, walk.entry(), answering(mesh, *end), *end);
    }
  }
  if (const double share = walk.entry().share(); !is_settled_at(share)) {
    open_touch_ = share;
  }
}

bool SightView::is_settled_at(double share) const noexcept {
  return !facts().has_voids || std::any_of(known.begin(), known.end(), [&](const auto& k) {
    return k.deviation < 0 && k.from <= share && share <= k.to &&
           (facts().final_settles || (k.beyond && facts().exact_settles));
  });
}

TriangleId SightView::answering(const BoundedSurface& mesh, const SightEnd& end) const {
  return answering_triangle(mesh.tin(), find_spot(mesh.tin(), &end == &a ? p() : q(), start_));
}

void SightView::add_piece(const BoundedSurface& mesh, const LinePiece& piece) {
  const Tin& tin = mesh.tin();
  SightPiece view;
  view.from = piece.from.share();
  view.to = piece.to.share();
  view.surface = piece.is_surface(tin);
  SurfaceBounds bounds = mesh.bounds(piece.triangle);
  if (piece.other != kNone) {  // what holds of either triangle holds on their common edge
    const SurfaceBounds other = mesh.bounds(piece.other);
    bounds.heights.hi = std::min(bounds.heights.hi, other.heights.hi);
    if (!is_surface(tin, piece.triangle)) {
      bounds.deviation = other.deviation;
    } else if (is_surface(tin, piece.other)) {
      bounds.deviation = std::min(bounds.deviation, other.deviation);
    }
  }
  view.deviation = bounds.deviation;
  view.highest = facts().heights.height_of_code(bounds.heights.hi);
  for (const KnownStretch& k : known) {
    if (k.from <= view.to && view.from <= k.to) {
      view.final = view.final || k.deviation < 0;
      view.exact = view.exact || (k.deviation < 0 && k.beyond);
      view.deviation = std::min(view.deviation, std::max(k.deviation, facts().finest_deviation));
    }
  }
  certify(view);
  if (view.surface) {
    const bool follows = !pieces.empty() && pieces.back().surface;
    view.ground_from = follows ? pieces.back().ground_to
                               : ground_of(codes_at(tin, facts().heights, piece.from.footing));
    view.ground_to = ground_of(codes_at(tin, facts().heights, piece.to.footing));
  }
  pieces.push_back(view);
}

/// Sets what is known of an end. The closed surface counts: an end on a vertex or an edge beside a
/// void stands on ground.
void SightView::set_end(const BoundedSurface& mesh, const Crossing& c, TriangleId t,
                        SightEnd& end) const {
  end.surface = is_surface(mesh.tin(), t) || is_surface(mesh.tin(), answering(mesh, end));
  if (!end.surface) {
    return;
  }
  const double deviation =
      end.known ? 0.0 : std::min(mesh.bounds(t).deviation, std::max(end_deviation, 0.0));
  stand_on(end, codes_at(mesh.tin(), facts().heights, c.footing),
           std::max(deviation, facts().file_deviation));
}

/// Walks once more, and decides in rationals what doubles could not.
void SightView::decide_exactly_all(const BoundedSurface& mesh) {
  const Tin& tin = mesh.tin();
  const bool is_open = std::any_of(pieces.begin(), pieces.end(), [](const SightPiece& p) {
    return p.verdict == PieceVerdict::kUndecided;
  });
  if (!is_open && !facts().has_voids && !pieces.empty()) {
    return;
  }
  LineWalk walk(tin, p(), q(), start_);
  if (walk.meets_domain() && pieces.empty()) {
    check_touch(mesh, walk.entry());
  }
  for (std::size_t i = 0; i < pieces.size() && walk.next(); ++i) {
    const LinePiece& piece = walk.piece();
    if (pieces[i].surface) {
      decide_exactly(pieces[i], line_point_of(tin, facts().heights, piece.from),
                     line_point_of(tin, facts().heights, piece.to));
    } else if (pieces[i].settled) {
      check_touch(mesh, piece.from);
      check_touch(mesh, piece.to);
    }
  }
}

/// Looks at a crossing where the line meets the surface in a single point: a vertex whose surface
/// triangles lie beside the line, or an end on the domain's border.
void SightView::check_touch(const BoundedSurface& mesh, const Crossing& c) {
  const Tin& tin = mesh.tin();
  if (!is_settled_at(c.share())) {  // the full TIN may have another class there
    open_touch_ = c.share();
    take_open_touch(c.share());
    return;
  }
  const LinePoint at = line_point_of(tin, facts().heights, c);
  bool touches = false;
  if (c.footing.lies() == Lies::kOnVertex) {
    touches = touches_surface(tin, c.footing.vertex[0]);
  } else if (!at.is_inner()) {  // an end on the domain's border, from where the line stays outside
    touches = is_surface(tin, answering(mesh, c.numerator == 0 ? a : b));
  }
  if (touches) {
    take_touch(at);
  }
}

}  // namespace ptin
