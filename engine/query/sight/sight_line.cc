// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_line.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "engine/geometry/infinity.h"

namespace ptin {

SightLine::SightLine(const SightFacts& facts, Spot p, Spot q, const SightPair& pair, bool absolute,
                     double bend)
    : facts_(facts),
      p_(p),
      q_(q),
      bend_(bend),
      magnitude_(std::abs(pair.height_a) + std::abs(pair.height_b) +
                 std::abs(facts.heights.offset) + bend +
                 std::max(std::abs(facts.min_height), std::abs(facts.max_height))) {
  a.height = pair.height_a;
  b.height = pair.height_b;
  for (SightEnd* end : {&a, &b}) {
    end->absolute = absolute;
    // Nothing is known of the ground but the heights of the whole terrain.
    const double deviation = facts.file_deviation;
    end->level = absolute ? Interval{end->height, end->height}
                          : Interval{facts.min_height - deviation + end->height,
                                     facts.max_height + deviation + end->height};
  }
  take_levels();
}

const SightPiece* SightLine::hidden_piece() const noexcept {
  const auto hidden = std::find_if(pieces.begin(), pieces.end(), [](const SightPiece& p) {
    return p.verdict == PieceVerdict::kHidden;
  });
  return hidden == pieces.end() ? nullptr : &*hidden;
}

void SightLine::take_levels() {
  ray_ = {a.level, b.level, bend_};
  touched_ = 2.0;
  may_be_touched_ = false;
  least_touch_ = {};
}

void SightLine::stand_on(SightEnd& end, const WeightedCodes& ground, double deviation) const {
  end.ground = ground;
  if (!end.absolute) {
    const double height = ground_of(ground) + end.height;
    end.level = {height - deviation, height + deviation};
  }
}

/// With u = 2^-53. Ground: 8u of the largest code from WeightedCodes::mean() and 3u of decoding.
/// The line: shares of 3u, products and sums of at most 12u of its largest term. 2^-46 of the sum
/// of all magnitudes is four times that.
double SightLine::rounding() const noexcept {
  const double ends = std::max(
      {std::abs(ray_.a.lo), std::abs(ray_.a.hi), std::abs(ray_.b.lo), std::abs(ray_.b.hi)});
  return std::ldexp(magnitude_ + ends, -46);
}

void SightLine::certify(SightPiece& p) const {
  p.settled = (p.final && facts_.final_settles) || (p.exact && facts_.exact_settles);
  const double least = p.exact ? facts_.file_deviation : facts_.finest_deviation;
  p.deviation =
      std::max(p.final ? std::min(p.deviation, least) : p.deviation, facts_.file_deviation);
  p.highest = std::min(p.highest, facts_.max_height) + facts_.file_deviation;
}

void SightLine::decide_by_bounds(SightPiece& p) const {
  const double slack = rounding();
  const double low0 = ray_.low(p.from), low1 = ray_.low(p.to);
  p.least = -kInfinity;
  p.most = kInfinity;
  p.guess = 0.0;
  p.guess_at = p.most_at = p.from;
  if (p.surface) {
    p.least = lowest_between(p.from, low0 - p.ground_from, p.to, low1 - p.ground_to, bend_).value -
              p.deviation - slack;
    const Lowest high = lowest_between(p.from, ray_.high(p.from) - p.ground_from, p.to,
                                       ray_.high(p.to) - p.ground_to, bend_);
    // Where the piece is not settled, the full TIN may have a void instead.
    p.most = facts_.has_voids && !p.settled ? kInfinity : high.value + p.deviation + slack;
    p.most_at = high.at;
    const Lowest guess = lowest_between(p.from, ray_.middle(p.from) - p.ground_from, p.to,
                                        ray_.middle(p.to) - p.ground_to, bend_);
    p.guess = guess.value;
    p.guess_at = guess.at;
  } else if (p.settled) {
    p.least = kInfinity;
  }
  p.least =
      std::max(p.least, lowest_between(p.from, low0, p.to, low1, bend_).value - p.highest - slack);
  p.verdict = p.least >= 0 ? PieceVerdict::kVisible
                           : (p.most < 0 ? PieceVerdict::kHidden : PieceVerdict::kUndecided);
}

SightPiece SightLine::united_on_edge(const SightPiece& x, const SightPiece& y) const {
  SightPiece piece = x.surface ? x : y;
  const SightPiece& other = x.surface ? y : x;
  const bool is_hidden = piece.verdict == PieceVerdict::kHidden;
  const bool is_visible = piece.verdict == PieceVerdict::kVisible;
  piece.highest = std::min(piece.highest, other.highest);
  if (other.surface) {
    piece.deviation = std::min(piece.deviation, other.deviation);
  }
  decide_by_bounds(piece);
  if (piece.verdict == PieceVerdict::kUndecided && (is_hidden || is_visible)) {  // exactly
    piece.verdict = is_hidden ? PieceVerdict::kHidden : PieceVerdict::kVisible;
  }
  return piece;
}

SightPiece SightLine::part_of(const SightPiece& piece, double from, double to) const {
  if (from == piece.from && to == piece.to) {
    return piece;
  }
  const auto ground_at = [&](double s) {
    return piece.ground_from +
           (piece.ground_to - piece.ground_from) * ((s - piece.from) / (piece.to - piece.from));
  };
  SightPiece part = piece;
  part.from = from;
  part.to = to;
  part.ground_from = from == piece.from ? piece.ground_from : ground_at(from);
  part.ground_to = to == piece.to ? piece.ground_to : ground_at(to);
  decide_by_bounds(part);
  part.least = std::max(part.least, piece.least);
  return part;
}

void SightLine::order_pieces() {
  std::sort(pieces.begin(), pieces.end(), [](const SightPiece& x, const SightPiece& y) {
    return std::tie(x.from, x.to, x.exact) < std::tie(y.from, y.to, y.exact);
  });
  std::size_t kept = 0;
  for (const SightPiece& p : pieces) {
    if (kept > 0) {
      SightPiece& last = pieces[kept - 1];
      if (last == p) {
        continue;
      }
      if (last.along_edge && p.along_edge && last.from == p.from && last.to == p.to &&
          last.exact == p.exact) {
        last = united_on_edge(last, p);
        continue;
      }
    }
    pieces[kept++] = p;
  }
  pieces.resize(kept);
}

void SightLine::prefer_exact() {
  std::vector<SightPiece> all;
  all.swap(pieces);
  std::vector<SightPiece> exact;
  std::copy_if(all.begin(), all.end(), std::back_inserter(exact),
               [](const SightPiece& p) { return p.exact; });
  for (const SightPiece& p : all) {
    double from = p.from;
    for (const SightPiece& e : exact) {
      if (!p.exact && !is_final_truth(p) && e.from < p.to && e.to > from) {
        if (e.from > from) {
          pieces.push_back(part_of(p, from, e.from));
        }
        from = e.to;
      }
    }
    if (from < p.to) {
      pieces.push_back(part_of(p, from, p.to));
    }
  }
}

ExactRay SightLine::exact_ray() const {
  return {facts_.heights,
          {a.height, a.absolute ? nullptr : &a.ground},
          {b.height, b.absolute ? nullptr : &b.ground},
          bend_};
}

void SightLine::decide_exactly(SightPiece& p, const LinePoint& from, const LinePoint& to) const {
  if (p.verdict != PieceVerdict::kUndecided || !p.surface || !is_final_truth(p) ||
      !can_be_exact()) {
    return;
  }
  // Along level ground both heights are the same number, which carries no rounding but that of
  // decoding.
  const bool is_level = bend_ == 0 && a.height == 0 && b.height == 0 && !a.absolute &&
                        !b.absolute && ray_.a.lo == ray_.b.lo && a.ground.is_level() &&
                        b.ground.is_level() && from.ground.is_level() && to.ground.is_level() &&
                        p.ground_from == ray_.a.lo && p.ground_to == ray_.a.lo;
  const int sign = is_level ? 0 : exact_ray().sign_over(from, to);
  p.verdict = sign < 0 ? PieceVerdict::kHidden : PieceVerdict::kVisible;
}

void SightLine::take_open_touch(double share) {
  const double least = ray_.low(share) - facts_.max_height - facts_.file_deviation - rounding();
  least_touch_.least = std::min(least_touch_.least, least);
  may_be_touched_ = may_be_touched_ || least < 0;
}

void SightLine::take_touch(const LinePoint& at) {
  const double share = at.share();
  const double ground = ground_of(at.ground);
  const double reach = can_be_exact() ? 0.0 : facts_.file_deviation + rounding();
  const Touch touch{ray_.low(share) - ground - reach, ray_.high(share) - ground + reach,
                    ray_.middle(share) - ground, share};
  // Of two alike the one that comes first along the way, in whatever order they were found.
  if (touch.guess < least_touch_.guess ||
      (touch.guess == least_touch_.guess && share < least_touch_.at)) {
    least_touch_.guess = touch.guess;
    least_touch_.at = share;
  }
  least_touch_.least = std::min(least_touch_.least, touch.least);
  least_touch_.most = std::min(least_touch_.most, touch.most);
  if (!at.is_inner()) {
    return;
  }
  const double slack = rounding();
  const bool is_close = can_be_exact() && std::abs(touch.guess) <= slack;
  if (is_close ? exact_ray().sign_at(at) < 0 : touch.most < 0) {
    touched_ = std::min(touched_, share);
  } else if (!can_be_exact() && touch.least < 0) {
    may_be_touched_ = true;
  }
}

}  // namespace ptin
