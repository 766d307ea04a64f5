// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_view.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// Whether what is known of a stretch holds for a piece. It holds for the triangles that the
/// stretch touches. Where records were left out because they end below the line, it holds only for
/// pieces within the stretch: beyond it the line may be lower.
bool is_known_by(const KnownStretch& k, const SightPiece& p) noexcept {
  return std::isinf(k.margin) ? k.from <= p.to && p.from <= k.to : k.from <= p.from && p.to <= k.to;
}

/// True when all codes of a footing are the same: its height then carries no rounding but that of
/// decoding.
bool is_level(const Tin& tin, const Footing& f) {
  for (std::size_t i = 1; i < static_cast<std::size_t>(f.count); ++i) {
    if (tin.vertices[f.vertex[i]].height != tin.vertices[f.vertex[0]].height) {
      return false;
    }
  }
  return true;
}

}  // namespace

double SightView::ground_at(const BoundedMesh& mesh, const Crossing& c) const {
  return facts_.heights.height_of_code(code_at(mesh.tin(), facts_.heights, c.footing));
}

void SightView::look(const BoundedMesh& mesh, TriangleId start) {
  pieces.clear();
  magnitude_ = std::abs(a.height) + std::abs(b.height) + std::abs(facts_.heights.offset);
  LineWalk walk(mesh.tin(), p_, q_, start);
  a.inside = walk.begins_inside();
  Crossing last = walk.entry();
  bool first = true;
  start_ = start;
  TriangleId last_triangle = kNone;
  bool last_surface = false;
  while (walk.next()) {
    const LinePiece& piece = walk.piece();
    add_piece(mesh, piece);
    last = piece.to;
    last_triangle = piece.triangle;
    last_surface = piece.is_surface(mesh.tin());
    if (first) {
      start_ = piece.triangle;
      if (a.inside) {
        set_end(mesh, piece.from, piece.triangle, last_surface, a);
      }
      first = false;
    }
  }
  b.inside = walk.ends_inside();
  if (b.inside && last_triangle != kNone) {
    set_end(mesh, last, last_triangle, last_surface, b);
  }
  touch_open_ = false;
  if (pieces.empty() && walk.meets_domain()) {
    set_only_point(mesh, walk);
  }
  set_level(a);
  set_level(b);
}

/// Looks at a line that meets the domain in one point alone: an end on the border from where the
/// line stays outside, or a corner of the domain that the line touches.
void SightView::set_only_point(const BoundedMesh& mesh, const LineWalk& walk) {
  for (SightEnd* end : {&a, &b}) {
    if (end->inside) {
      const TriangleId t = answering(mesh, *end, start_);
      set_end(mesh, walk.entry(), t, mesh.tin().classes[t] == TriangleClass::kSurface, *end);
    }
  }
  touch_open_ =
      facts_.has_voids &&
      !(facts_.exact_settles && std::any_of(known.begin(), known.end(), [&](const auto& k) {
          const double share = walk.entry().share();
          return k.deviation < 0 && k.beyond && k.from <= share && share <= k.to;
        }));
}

TriangleId SightView::answering(const BoundedMesh& mesh, const SightEnd& end,
                                TriangleId near) const {
  return answering_triangle(mesh.tin(), find_spot(mesh.tin(), &end == &a ? p_ : q_, near));
}

void SightView::add_piece(const BoundedMesh& mesh, const LinePiece& piece) {
  const Tin& tin = mesh.tin();
  SightPiece view;
  view.from = piece.from.share();
  view.to = piece.to.share();
  view.surface = piece.is_surface(tin);
  SurfaceBounds bounds = mesh.bounds(piece.triangle);
  if (piece.other != kNone) {  // what holds of either triangle holds on their common edge
    const SurfaceBounds other = mesh.bounds(piece.other);
    bounds.heights.hi = std::min(bounds.heights.hi, other.heights.hi);
    if (tin.classes[piece.triangle] != TriangleClass::kSurface) {
      bounds.deviation = other.deviation;
    } else if (tin.classes[piece.other] == TriangleClass::kSurface) {
      bounds.deviation = std::min(bounds.deviation, other.deviation);
    }
  }
  view.deviation = std::min(bounds.deviation, facts_.base_deviation);
  for (const KnownStretch& k : known) {
    if (is_known_by(k, view)) {
      view.final = view.final || k.deviation < 0;
      view.exact = view.exact || (k.deviation < 0 && k.beyond);
      view.deviation = std::min(view.deviation, std::max(k.deviation, 0.0));
    }
  }
  view.settled = (view.final && facts_.final_settles) || (view.exact && facts_.exact_settles);
  view.deviation = std::max(view.final ? 0.0 : view.deviation,
                            view.exact ? facts_.file_deviation : facts_.finest_deviation);
  view.highest = std::min(facts_.heights.height_of_code(bounds.heights.hi), facts_.max_height) +
                 facts_.file_deviation;
  if (view.surface) {
    const bool follows = !pieces.empty() && pieces.back().surface;
    view.ground_from = follows ? pieces.back().ground_to : ground_at(mesh, piece.from);
    view.ground_to = ground_at(mesh, piece.to);
    magnitude_ = std::max({magnitude_, std::abs(view.ground_from), std::abs(view.ground_to)});
  }
  pieces.push_back(view);
}

/// Sets what is known of an end. The closed surface counts: an end on a vertex or an edge beside a
/// void stands on ground.
void SightView::set_end(const BoundedMesh& mesh, const Crossing& c, TriangleId t, bool surface,
                        SightEnd& end) const {
  const Tin& tin = mesh.tin();
  end.footing = c.footing;
  end.surface = surface;
  if (!surface) {
    const TriangleId other = answering(mesh, end, t);
    end.surface = other != kNone && tin.classes[other] == TriangleClass::kSurface;
  }
  if (!end.surface || end.absolute) {
    return;
  }
  const double ground = ground_at(mesh, c);
  double deviation = std::min(mesh.bounds(t).deviation, facts_.base_deviation);
  deviation = end.known ? 0.0 : std::min(deviation, std::max(end.deviation, 0.0));
  deviation = std::max(deviation, facts_.file_deviation);
  end.level = {ground + end.height - deviation, ground + end.height + deviation};
}

void SightView::set_level(SightEnd& end) const {
  if (end.absolute) {
    end.level = {end.height, end.height};
  }
}

/// With u = 2^-53. Ground: 8u of the largest code from code_at and 3u of decoding. The line: shares
/// of 3u, products and sums of at most 12u of its largest term. 2^-46 of the sum of all magnitudes
/// is four times that.
double SightView::rounding() const noexcept {
  const double ends = std::max(
      {std::abs(ray_.a.lo), std::abs(ray_.a.hi), std::abs(ray_.b.lo), std::abs(ray_.b.hi)});
  return std::ldexp(magnitude_ + ends + bend, -46);
}

void SightView::decide(const BoundedMesh& mesh) {
  ray_ = {a.level, b.level, bend};
  any_exact_ = false;
  touched_ = 2.0;
  least_touch_ = {kInfinity, 0.0};
  for (SightPiece& piece : pieces) {
    decide_by_bounds(piece);
    any_exact_ = any_exact_ || (is_final_truth(piece) && piece.verdict == PieceVerdict::kUndecided);
  }
  if (facts_.file_deviation == 0 && knows_levels() &&
      (any_exact_ || facts_.has_voids || pieces.empty())) {
    decide_exactly(mesh);
  }
}

void SightView::decide_by_bounds(SightPiece& p) const {
  const double slack = rounding();
  const double low0 = ray_.low(p.from), low1 = ray_.low(p.to);
  p.least = -kInfinity;
  p.most = kInfinity;
  p.guess = 0.0;
  p.guess_at = p.from;
  if (p.surface) {
    p.least = lowest_between(p.from, low0 - p.ground_from, p.to, low1 - p.ground_to, bend).value -
              p.deviation - slack;
    const Lowest high = lowest_between(p.from, ray_.high(p.from) - p.ground_from, p.to,
                                       ray_.high(p.to) - p.ground_to, bend);
    // Where the piece is not settled, the full TIN may have a void instead.
    p.most = facts_.has_voids && !p.settled ? kInfinity : high.value + p.deviation + slack;
    const Lowest guess = lowest_between(p.from, ray_.middle(p.from) - p.ground_from, p.to,
                                        ray_.middle(p.to) - p.ground_to, bend);
    p.guess = guess.value;
    p.guess_at = guess.at;
  } else if (p.settled) {
    p.least = kInfinity;
  }
  p.least =
      std::max(p.least, lowest_between(p.from, low0, p.to, low1, bend).value - p.highest - slack);
  p.verdict = p.least >= 0 ? PieceVerdict::kVisible
                           : (p.most < 0 ? PieceVerdict::kHidden : PieceVerdict::kUndecided);
}

/// Walks once more, and decides in rationals what doubles could not tell.
void SightView::decide_exactly(const BoundedMesh& mesh) {
  const Tin& tin = mesh.tin();
  const ExactRay exact(tin, facts_.heights, {a.height, a.absolute ? nullptr : &a.footing},
                       {b.height, b.absolute ? nullptr : &b.footing}, bend);
  const bool level_line = bend == 0 && a.height == 0 && b.height == 0 && !a.absolute &&
                          !b.absolute && ray_.a.lo == ray_.b.lo && is_level(tin, a.footing) &&
                          is_level(tin, b.footing);
  LineWalk walk(tin, p_, q_, start_);
  if (walk.meets_domain() && pieces.empty() && !touch_open_) {
    check_touch(mesh, walk.entry(), exact);
  }
  for (std::size_t i = 0; i < pieces.size() && walk.next(); ++i) {
    const LinePiece& piece = walk.piece();
    SightPiece& view = pieces[i];
    if (is_final_truth(view) && view.surface && view.verdict == PieceVerdict::kUndecided) {
      const bool same_level = level_line && is_level(tin, piece.from.footing) &&
                              is_level(tin, piece.to.footing) && view.ground_from == ray_.a.lo &&
                              view.ground_to == ray_.a.lo;
      const int sign = same_level ? 0 : exact.sign_over(piece);
      view.verdict = sign < 0 ? PieceVerdict::kHidden : PieceVerdict::kVisible;
    }
    if (facts_.has_voids && view.settled && !view.surface) {
      check_touch(mesh, piece.from, exact);
      check_touch(mesh, piece.to, exact);
    }
  }
}

/// Looks at a crossing where the line meets the surface in a single point: a vertex whose surface
/// triangles lie beside the line, or an end on the domain's border. An end of the line there does
/// not hide the line.
void SightView::check_touch(const BoundedMesh& mesh, const Crossing& c, const ExactRay& exact) {
  const bool inner = c.numerator > 0 && c.numerator < c.denominator;
  if (c.footing.lies() == Lies::kOnVertex) {
    if (!touches_surface(mesh.tin(), c.footing.vertex[0])) {
      return;
    }
  } else {  // an end on the domain's border, from where the line stays outside
    const Place place = find_spot(mesh.tin(), c.numerator == 0 ? p_ : q_, start_);
    const TriangleId t = answering_triangle(mesh.tin(), place);
    if (inner || t == kNone || mesh.tin().classes[t] != TriangleClass::kSurface) {
      return;
    }
  }
  const double share = c.share();
  const double clearance = ray_.low(share) - ground_at(mesh, c);
  if (clearance < least_touch_.value) {
    least_touch_ = {clearance, share};
  }
  if (inner && (clearance < -rounding() || (clearance < rounding() && exact.sign_at(c) < 0))) {
    touched_ = std::min(touched_, share);
  }
}

}  // namespace ptin
