// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_stars.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// Shares of the way that are computed in doubles are off by less than this: coordinates are exact
/// doubles, so a difference, a quotient and their use round a share of at most 1 by some 2^-51.
constexpr double kShareSlack = 0x1p-40;

}  // namespace

SightStars::SightStars(const OpenedTerrain& terrain, const SightFacts& facts,
                       const SightRequest& request, const CoarseGround* coarse,
                       const SightLine& line, QueryContext& context)
    : SightSearch(facts, request, context),
      terrain_(terrain),
      coarse_(coarse),
      line_(line),
      origin_(grid_of(line.p())),
      full_detail_(terrain.store()),
      asked_(terrain.store(), *facts.detail),
      full_(terrain.store(), full_detail_) {
  const MapPoint end = grid_of(line.q());
  way_ = {end.x - origin_.x, end.y - origin_.y};
  state_domain(line_.a, line_.p());
  state_domain(line_.b, line_.q());
}

/// States where an end lies, before the ground below it is known: T0 covers the domain, and is
/// ground where the terrain has no void.
void SightStars::state_domain(SightEnd& end, Spot spot) const {
  visit_living(terrain_.store().t0(), kInfinity, [&](const LivingTriangle& t) {
    if (holds(t, spot)) {
      end.inside = true;
      end.surface = end.surface || !t.is_void;
    }
  });
}

void SightStars::find_ends() {
  const std::array<Spot, 2> spots{line_.p(), line_.q()};
  const std::array<SightEnd*, 2> ends{&line_.a, &line_.b};
  std::array<TriangleAt, 2> at;
  for (std::size_t i = 0; i < 2; ++i) {
    SightEnd& end = *ends[i];
    end.known = true;
    if (end.inside) {
      // Ends stand on the full TIN at any level of detail: a coarse one would lift or sink them.
      find_triangles(terrain_, full_detail_, {&spots[i], 1}, {&at[i], 1}, 0, context_, &recent_);
    }
    end.surface = at[i].is_found && !at[i].triangle.is_void;
    if (end.surface) {
      line_.stand_on(end, codes_in(at[i].triangle, facts_.heights, spots[i]),
                     facts_.file_deviation);
    }
  }
  line_.take_levels();
  for (std::size_t i = 0; i < 2 && facts_.is_level_asked && line_.ends_defined(); ++i) {
    // The triangle of the full TIN below an end is at hand, and is exact where the level is not.
    if (at[i].is_found) {
      begin_search(Aim::kWhole, {0.0, 1.0}, full_);
      take(at[i].triangle);
    }
  }
}

/// The part of the way whose points may lie in a box, none missing.
std::optional<SightStars::Part> SightStars::part_in(const GridBox& box) const noexcept {
  Part part = part_;
  const auto cut = [&](double begin, double way, double low, double high) {
    // A line in parallel to an axis is within the limits all along, or nowhere.
    if (way == 0) {
      return low <= begin && begin <= high;
    }
    const double s0 = (low - begin) / way;
    const double s1 = (high - begin) / way;
    part.from = std::max(part.from, std::min(s0, s1) - kShareSlack);
    part.to = std::min(part.to, std::max(s0, s1) + kShareSlack);
    return part.from <= part.to;
  };
  if (!cut(origin_.x, way_.x, box.min_x, box.max_x) ||
      !cut(origin_.y, way_.y, box.min_y, box.max_y)) {
    return std::nullopt;
  }
  return part;
}

/// A box that meets every box of whole coordinates that meets the part.
GridBox SightStars::box_of(const Part& part) const noexcept {
  const double x0 = origin_.x + part.from * way_.x;
  const double x1 = origin_.x + part.to * way_.x;
  const double y0 = origin_.y + part.from * way_.y;
  const double y1 = origin_.y + part.to * way_.y;
  const auto whole = [](double v) {
    // A line may end beyond 32 bits, but no star lies there: nothing is lost by the limits.
    return static_cast<std::int32_t>(std::clamp(v, -0x1p31, 0x1p31 - 1));
  };
  return {whole(std::floor(std::min(x0, x1))), whole(std::floor(std::min(y0, y1))),
          whole(std::ceil(std::max(x0, x1))), whole(std::ceil(std::max(y0, y1)))};
}

Merit SightStars::bound(const StarAttributes& a) const { return bound_of_cells(a.box, a.heights); }

Merit SightStars::bound_of_cells(const GridBox& box, const Interval& codes) const {
  const std::optional<Part> part = part_in(box);
  if (!part) {
    return {-kInfinity};
  }
  if (wants_all()) {
    return {0.0};
  }
  const double top =
      facts_.heights.height_of_code(codes.hi) + facts_.finest_deviation + line_.rounding();
  const Ray& ray = line_.ray();
  const double above = top - ray.lowest(part->from, part->to);
  // All that doubles and the level may hide of a height is in `top`, so the bound errs upward.
  if (aim_ != Aim::kFirst) {
    return {above};
  }
  if (above < 0) {
    return {-kInfinity};
  }
  // With s = from + t width the ray bends by bend width^2. The bound is the negative of the share
  // at which the ray may first fall to `top`, earlier by the slack, since shares are rounded: so
  // falling merit is the order along the way.
  const double width = part->to - part->from;
  const double t =
      first_zero(ray.low(part->from) - top, ray.low(part->to) - top, ray.bend * width * width);
  return {-(part->from + t * width - kShareSlack)};
}

/// Pages and subtrees of smaller bounds do not matter any more.
double SightStars::cut_off() const noexcept {
  switch (aim_) {
    case Aim::kVerdict:
      // Stars below 0 end below the line. One hidden piece is the verdict, and ends the search.
      return first_hidden_ <= 1.0 ? kInfinity : 0.0;
    case Aim::kLeast:
      // A star that ends farther than most_ below the line holds no smaller clearance.
      return -most_;
    case Aim::kFirst:
      // Merit is a negative share: what lies behind the first hidden piece is below.
      return -first_hidden_;
    case Aim::kWhole:
    case Aim::kTouch:
      break;
  }
  return 0.0;
}

/// Sets what matters of a page whose stars the line passes on a part of the way.
void SightStars::look_at(const Part& part) {
  filter_.box = box_of(part);
  filter_.heights = kAllHeights;
  lowest_ = -kInfinity;
  if (wants_all()) {
    return;
  }
  lowest_ = line_.ray().lowest(part.from, part.to) - facts_.finest_deviation - line_.rounding() -
            (aim_ == Aim::kLeast ? most_ : 0.0);
  const double code = (lowest_ - facts_.heights.offset) / facts_.heights.step;
  // rounding() counts the offset in, so the difference is covered; the quotient rounds by 2^-53,
  // for which 1e-9 is ample. The filter may let through too much, and must never keep a star out.
  if (std::isfinite(code)) {
    filter_.heights.lo = code - 1e-9 * (1 + std::abs(code));
  }
}

/// Whether the budget ends the search before what has such a bound.
bool SightStars::is_cut_here(Merit bound) {
  context_.check_stop();
  is_cut_ = out_of_budget();
  cut_bound_ = is_cut_ ? bound.value : cut_bound_;
  return is_cut_;
}

bool SightStars::begin_cells(const GridBox& box, Merit left) {
  if (is_cut_here(left)) {
    return false;
  }
  look_at(part_in(box).value_or(part_));
  // Twice, since prefer_exact() copies the pieces into another array.
  context_.admit(2 * line_.pieces.capacity() * sizeof(SightPiece) +
                 (coarse_ == nullptr ? 0 : coarse_->bytes()));
  return true;
}

void SightStars::will_visit(std::span<const GridBox> stars) {
  terrain_.store().announce_heights(stars, context_.heights(), context_.cost.io);
}

Merit SightStars::visit(PageId page, const StarAttributes& a) {
  if (is_cut_here(bound(a))) {
    return kBestMerit;
  }
  look_at(part_in(a.box).value_or(part_));
  stars_->read(page, filter_, context_);
  stars_->visit_page([&](const GridBox& box) { return meets(box, filter_.box); },
                     [&](const LivingTriangle& t) { take(t); });
  // Twice, since prefer_exact() copies the pieces into another array.
  context_.admit(2 * line_.pieces.capacity() * sizeof(SightPiece) + stars_->bytes_aside() +
                 (coarse_ == nullptr ? 0 : coarse_->bytes()));
  return {cut_off()};
}

void SightStars::begin_search(Aim aim, Part part, LevelStars& stars) {
  aim_ = aim;
  part_ = part;
  stars_ = &stars;
  stars.clear();
  set_level(stars.detail(), filter_);
  is_cut_ = false;
  look_at(part);
}

/// Looks for triangles of a level along a part of the way.
void SightStars::search(Aim aim, Part part, LevelStars& stars) {
  begin_search(aim, part, stars);
  if (const Floor* const floor = floor_for(terrain_, stars.detail())) {
    visit_floor_best_first(*floor, facts_.heights, box_of(part), *this, {cut_off()}, recent_,
                           context_.cost);
    return;
  }
  stars.visit_t0([&](const GridBox& box) { return meets(box, filter_.box); },
                 [&](const LivingTriangle& t) { take(t); });
  StarFilter filter;
  set_level(stars.detail(), filter);
  filter.box = box_of(part);
  terrain_.store().star_index().search_stars_best_first(filter, *this, {cut_off()},
                                                        context_.cost.io);
  finish_search();
}

/// Takes what was set aside. The star that shows such a triangle to be gone has bounds at least as
/// large as the triangle's own. So it was read wherever the triangle's bound is not below the
/// cut-off, and no other triangle matters.
void SightStars::finish_search() {
  look_at(part_);
  if (is_cut_) {
    stars_->abandon([&](const LivingTriangle& t) { take_abandoned(t); });
    return;
  }
  const double end = cut_off();
  stars_->settle([&](const LivingTriangle& t) {
    StarAttributes own;
    own.box = ptin::box_of(t);
    own.heights = {kInfinity, -kInfinity};
    for (const LivingTriangle::Corner& c : t.corner) {
      own.heights = united(own.heights, facts_.heights.code(c.height));
    }
    if (bound(own).value >= end) {
      take(t);
    }
  });
}

/// Takes a triangle that may be gone: its bounds hold all the same.
void SightStars::take_abandoned(const LivingTriangle& t) {
  if (const auto on = shared_stretch(t, facts_.heights, line_.p(), line_.q());
      on && !on->is_point) {
    line_.pieces.push_back(piece_of(t, *on, false));
  }
}

/// Where the budget ends a search, all that was not read is one piece of which nothing is known but
/// the highest ground of the terrain.
void SightStars::search_whole_line(Aim aim) {
  search(aim, {0.0, 1.0}, asked_);
  if (!is_cut_) {
    return;
  }
  SightPiece unread;
  unread.to = 1.0;
  unread.deviation = kInfinity;
  unread.highest = facts_.max_height;
  line_.certify(unread);
  line_.decide_by_bounds(unread);
  // Pages come by falling bound, so none that is left exceeds the bound of the page at the cut.
  if (aim == Aim::kLeast) {
    unread.least = std::max(unread.least, -cut_bound_);
  } else if (aim == Aim::kFirst) {
    unread.least = std::max(unread.least, most_);
  }
  line_.pieces.push_back(unread);
}

SightPiece SightStars::piece_of(const LivingTriangle& t, const SharedStretch& on,
                                bool is_final) const {
  SightPiece piece;
  piece.from = on.from.share();
  piece.to = on.to.share();
  piece.along_edge = on.along_edge;
  piece.surface = !t.is_void;
  piece.final = is_final;
  piece.exact = is_final && (stars_ == &full_ || !facts_.is_level_asked);
  piece.deviation = t.deviation;
  piece.highest = facts_.heights.height_of_code(t.heights.hi);
  line_.certify(piece);
  if (piece.surface) {
    piece.ground_from = line_.ground_of(on.from.ground);
    piece.ground_to = line_.ground_of(on.to.ground);
    // The ground at an end is one number: on an edge weights depend on the triangle, so the ground
    // that was found for the end stands for all pieces that meet there.
    if (piece.exact && on.from.numerator == 0 && line_.a.known) {
      piece.ground_from = line_.ground_of(line_.a.ground);
    }
    if (piece.exact && on.to.numerator == on.to.denominator && line_.b.known) {
      piece.ground_to = line_.ground_of(line_.b.ground);
    }
  }
  line_.decide_by_bounds(piece);
  return piece;
}

void SightStars::take_touch(const LivingTriangle& t, const LinePoint& at) {
  const bool is_exact = stars_ == &full_ || !facts_.is_level_asked;
  if (!facts_.final_settles && !(is_exact && facts_.exact_settles)) {
    open_touch_ = at.is_inner() ? at.share() : open_touch_;
  } else if (!t.is_void && (is_exact || at.ground.count == 1)) {  // a vertex is as in the full TIN
    line_.take_touch(at);
    first_hidden_ = std::min(first_hidden_, line_.touched_at());
  }
}

void SightStars::take(const LivingTriangle& t) {
  if (!meets(ptin::box_of(t), filter_.box)) {
    return;
  }
  // A void is void in the full TIN too, and hides nothing: where that is not so all is wanted.
  if (!wants_all()) {
    const auto is_low = [&](const LivingTriangle::Corner& c) {
      return facts_.heights.height(c.height) < lowest_;
    };
    if (t.is_void || std::all_of(t.corner.begin(), t.corner.end(), is_low)) {
      return;
    }
  }
  const std::optional<SharedStretch> on = shared_stretch(t, facts_.heights, line_.p(), line_.q());
  if (!on) {
    return;
  }
  if (on->is_point) {
    take_touch(t, on->from);
    return;
  }
  if (aim_ == Aim::kTouch) {
    return;
  }
  SightPiece piece = piece_of(t, *on, true);
  if (!piece.surface && piece.along_edge && (piece.to < part_.from || piece.from > part_.to)) {
    return;  // the triangle on the edge's other side, which may be surface, need not be read
  }
  line_.decide_exactly(piece, on->from, on->to);
  most_ = std::min(most_, piece.most);
  if (piece.verdict == PieceVerdict::kHidden) {
    first_hidden_ = std::min(first_hidden_, piece.from);
  }
  line_.pieces.push_back(piece);
}

/// True when the full surface hides the line for certain, by the coarse level alone. The ends are
/// then as certain as that level, unless they are known already.
bool SightStars::is_hidden_by_coarse() {
  // Coarse surface may be a void in the full TIN, so beside voids it hides nothing for certain.
  if (coarse_ == nullptr || facts_.has_voids) {
    return false;
  }
  const std::array<Spot, 2> spots{line_.p(), line_.q()};
  const std::array<SightEnd*, 2> ends{&line_.a, &line_.b};
  for (std::size_t i = 0; i < 2 && !ends_known(); ++i) {
    if (const LivingTriangle* t = coarse_->find(spots[i]); t != nullptr) {
      line_.stand_on(*ends[i], codes_in(*t, facts_.heights, spots[i]),
                     std::max(t->deviation, facts_.file_deviation));
    }
  }
  line_.take_levels();
  part_ = {0.0, 1.0};
  const Ray& ray = line_.ray();
  // What rises above the line at its highest rises above it wherever the ends truly are.
  const Ray upper{{ray.a.hi, ray.a.hi}, {ray.b.hi, ray.b.hi}, ray.bend};
  bool is_hidden = false;
  coarse_->search(
      [&](const GridBox& box, const CoarseGround::Top& top) {
        const std::optional<Part> part = part_in(box);
        return part ? top.certain - upper.lowest(part->from, part->to) : 0.0;
      },
      [&](const LivingTriangle& t) {
        if (const auto on = shared_stretch(t, facts_.heights, line_.p(), line_.q());
            on && !on->is_point) {
          const SightPiece piece = piece_of(t, *on, false);
          is_hidden = piece.verdict == PieceVerdict::kHidden;
          if (is_hidden) {
            line_.pieces.push_back(piece);
          }
        }
        return !is_hidden;
      });
  return is_hidden;
}

/// Where the coarse level rises highest above the line; none where it does not.
std::optional<double> SightStars::likely_share() const {
  std::optional<double> share;
  if (coarse_ == nullptr) {
    return share;
  }
  double least = 0.0;
  const Ray& ray = line_.ray();
  coarse_->search(
      [&](const GridBox& box, const CoarseGround::Top& top) {
        const std::optional<Part> part = part_in(box);
        // `least` is negative once a triangle rises above the line: then only higher ones come.
        return part ? top.surface - ray.lowest(part->from, part->to) + least : 0.0;
      },
      [&](const LivingTriangle& t) {
        if (const auto on = shared_stretch(t, facts_.heights, line_.p(), line_.q());
            on && !on->is_point) {
          if (const SightPiece piece = piece_of(t, *on, false); piece.guess < least) {
            least = piece.guess;
            share = piece.guess_at;
          }
        }
        return true;
      });
  return share;
}

void SightStars::decide_by_search() {
  if (!facts_.final_settles) {
    search_whole_line(Aim::kWhole);
    return;
  }
  // What costs least comes first: the coarse level reads no page, the ends read those of two
  // points, and the page at the likely share may hold what hides the line.
  if (is_hidden_by_coarse()) {
    return;
  }
  if (!ends_known()) {
    finish_ends();
    if (is_hidden_by_coarse()) {
      return;
    }
  }
  if (const std::optional<double> share = likely_share()) {
    search(Aim::kVerdict, {*share, *share}, asked_);
  }
  if (first_hidden_ > 1.0) {
    search_whole_line(Aim::kVerdict);
  }
}

void SightStars::finish_line() {
  if (facts_.has_voids || request_.wavelength > 0) {
    search_whole_line(Aim::kWhole);
    return;
  }
  // The clearance at an end is its height above the ground: a bound of the smallest one, before any
  // page is read.
  for (const SightEnd* end : {&line_.a, &line_.b}) {
    if (end->known && end->surface) {
      most_ = std::min(most_, end->level.hi - line_.ground_of(end->ground) +
                                  facts_.finest_deviation + 2 * line_.rounding());
    }
  }
  search_whole_line(Aim::kLeast);
  if (first_hidden_ <= 1.0) {
    search_whole_line(Aim::kFirst);
  }
}

}  // namespace ptin
