// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

constexpr double kEverything = -1.0;  ///< As a deviation: no record is left out.

}  // namespace

SightSearch::SightSearch(const SightFacts& facts, const SightRequest& request, BoundedMesh& mesh,
                         QueryContext& context, double step)
    : facts_(facts),
      request_(request),
      mesh_(mesh),
      context_(context),
      step_(step),
      view_(facts, {}, {}) {}

void SightSearch::begin(Spot p, Spot q, const SightPair& pair, double bend, TriangleId start) {
  p_ = p;
  q_ = q;
  start_ = start;
  view_ = SightView(facts_, p, q);
  view_.bend = bend;
  for (SightEnd* end : {&view_.a, &view_.b}) {
    end->absolute = request_.absolute;
    end->deviation = kInfinity;
  }
  view_.a.height = pair.height_a;
  view_.b.height = pair.height_b;
  look();
}

void SightSearch::look() {
  view_.look(mesh_, start_);
  start_ = view_.start();  // triangles keep their numbers
  view_.decide(mesh_);
}

/// Of absolute ends only the states are asked, and only voids can change a state.
bool SightSearch::ends_known() const noexcept {
  return (view_.a.known && view_.b.known) ||
         (request_.absolute && (!facts_.has_voids || request_.verdict_only));
}

bool SightSearch::out_of_budget() const noexcept {
  return request_.budget && context_.cost.records_retrieved >= *request_.budget;
}

void SightSearch::finish_ends() {
  if (!ends_known() && !out_of_budget()) {
    refine({}, kEverything, 0.0);
  }
}

void SightSearch::finish_line() {
  while (!out_of_budget()) {
    std::vector<Stretch> stretches = unfinished_stretches();
    if (stretches.empty()) {
      return;
    }
    refine(std::move(stretches), kEverything, kInfinity);
  }
}

/// The stretches where the line is not final: with all their records at once, or with a budget step
/// by step, so that the last step alone overruns it.
std::vector<SightPredicate::Stretch> SightSearch::unfinished_stretches() const {
  std::vector<Stretch> stretches;
  for (const SightPiece& p : view_.pieces) {
    if (!p.final) {
      add(stretches, p.from, p.to, request_.budget ? quarter_of(p.deviation) : kEverything);
    }
  }
  return stretches;
}

/// Refines the one point in which the line meets the domain, as far as the file goes.
void SightSearch::settle_touch() {
  refine({{0.0, 1.0, kEverything, -kInfinity, true}}, kEverything, kInfinity);
}

/// Adds the records that the stretches and ends ask for, notes in `known` what is applied, and
/// looks again. `margin` tells what cut_below_line() left out of the stretches: records whose
/// surface ends lower than `margin` below the lowest height of the line there.
void SightSearch::refine(std::vector<Stretch> stretches, double end_deviation, double margin) {
  const bool asks_ends = !ends_known();
  const double ends = asks_ends ? end_deviation : kInfinity;
  for (const Stretch& s : stretches) {
    view_.known.push_back({s.from, s.to, s.deviation,
                           std::isinf(s.lowest_code) ? kInfinity : margin,
                           s.beyond || !facts_.is_level_asked});
  }
  const SightPredicate wanted(p_, q_, std::move(stretches), ends, facts_.tolerance);
  const SightPredicate beyond = wanted.beyond();
  mesh_.refine(wanted, context_, facts_.is_level_asked ? &beyond : nullptr);
  if (asks_ends) {
    for (SightEnd* end : {&view_.a, &view_.b}) {
      end->deviation = std::min(end->deviation, ends);
      end->known = end->known || ends < 0;
    }
  }
  look();
}

/// The deviation to ask for, so that a piece is likely to be decided whose clearance is `margin`
/// and whose deviation is `deviation`: at most half of that deviation. Every record is asked for
/// where the deviation wanted would be too small for a search of its own.
double SightSearch::target(double margin, double deviation) const noexcept {
  // Where nothing is known, over T0, the margin is infinite: a first look asks for a sixteenth of
  // the relief (256 steps).
  const double share = ends_known() ? 0.7 : 0.45;
  const double wanted = std::isfinite(margin) ? std::min(share * std::abs(margin), 0.5 * deviation)
                                              : std::min(0.5 * deviation, 256 * step_);
  return wanted > std::max(step_, facts_.finest_deviation) ? wanted : kEverything;
}

double SightSearch::quarter_of(double deviation) const noexcept {
  const double quarter = std::min(deviation / 4, 256 * step_);
  return quarter > std::max(step_, facts_.finest_deviation) ? quarter : kEverything;
}

/// Adds a stretch; joins it to the last one where it follows that.
void SightSearch::add(std::vector<Stretch>& stretches, double from, double to,
                      double deviation) const {
  if (!stretches.empty() && stretches.back().to == from) {
    Stretch& last = stretches.back();
    last.to = to;
    last.deviation = std::min(last.deviation, deviation);
  } else {
    stretches.push_back({from, to, deviation, -kInfinity});
  }
}

/// Leaves out of each stretch the records whose surface ends lower than `margin` below the lowest
/// height of the line there. With voids it leaves out none, since such a record may still say what
/// is void above.
void SightSearch::cut_below_line(std::vector<Stretch>& stretches, double margin) const {
  if (facts_.has_voids) {
    return;
  }
  for (Stretch& s : stretches) {
    const double lowest = view_.ray().lowest(s.from, s.to) - margin;
    const double code = (lowest - facts_.heights.offset) / facts_.heights.step;
    s.lowest_code = std::isfinite(code) ? code - 1e-9 * (1 + std::abs(code)) : -kInfinity;
  }
}

const SightPiece* SightSearch::hidden_piece() const noexcept {
  const auto hidden = std::find_if(view_.pieces.begin(), view_.pieces.end(), [](const auto& p) {
    return p.verdict == PieceVerdict::kHidden;
  });
  return hidden == view_.pieces.end() ? nullptr : &*hidden;
}

SightVerdict SightSearch::decide() {
  while (true) {
    if (hidden_piece() != nullptr || view_.is_touched_from_below()) {
      return SightVerdict::kHidden;
    }
    const bool undecided = std::any_of(view_.pieces.begin(), view_.pieces.end(), [](const auto& p) {
      return p.verdict == PieceVerdict::kUndecided;
    });
    if (!undecided && !view_.is_touch_open()) {
      return SightVerdict::kVisible;
    }
    if (out_of_budget()) {
      return SightVerdict::kUndecided;
    }
    if (view_.is_touch_open()) {
      if (!view_.known.empty()) {
        return SightVerdict::kUndecided;  // the file does not know its voids
      }
      settle_touch();
      continue;
    }
    std::vector<Stretch> stretches = undecided_stretches();
    if (stretches.empty() && ends_known()) {
      stretches = unsettled_stretch();
      if (stretches.empty()) {
        return SightVerdict::kUndecided;  // neither the file nor the level of detail says more
      }
    }
    double ends = kInfinity;
    for (const Stretch& s : stretches) {
      ends = std::min(ends, s.deviation);
    }
    refine(std::move(stretches), std::isinf(ends) ? kEverything : ends, 0.0);
  }
}

/// What to refine next. If the mesh rises above the line somewhere: the one point that is most
/// likely to hide the line. Else all undecided pieces, since each of them must turn out visible.
std::vector<SightPredicate::Stretch> SightSearch::undecided_stretches() const {
  const SightPiece* likely = nullptr;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kUndecided && !p.final && p.surface && p.guess < 0 &&
        (likely == nullptr || p.guess < likely->guess)) {
      likely = &p;
    }
  }
  std::vector<Stretch> stretches;
  if (likely != nullptr) {
    const double deviation =
        facts_.has_voids ? kEverything : target(likely->guess, likely->deviation);
    stretches.push_back({likely->guess_at, likely->guess_at, deviation, -kInfinity});
  } else {
    for (const SightPiece& p : view_.pieces) {
      if (p.verdict == PieceVerdict::kUndecided && !p.final) {
        add(stretches, p.from, p.to, p.surface ? target(p.guess, p.deviation) : kEverything);
      }
    }
  }
  if (likely == nullptr) {
    cut_below_line(stretches, 0.0);
  }
  return stretches;
}

/// The one point that hides the line unless it is a void, which only records beyond the level of
/// detail tell; empty when there is none.
std::vector<SightPredicate::Stretch> SightSearch::unsettled_stretch() const {
  const SightPiece* likely = nullptr;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kUndecided && facts_.has_voids && p.surface && !p.exact &&
        p.guess < -p.deviation && (likely == nullptr || p.guess < likely->guess)) {
      likely = &p;
    }
  }
  if (likely == nullptr) {
    return {};
  }
  return {{likely->guess_at, likely->guess_at, kEverything, -kInfinity, true}};
}

const SightPiece* SightSearch::find_first_hidden() {
  while (true) {
    const auto first = std::find_if(view_.pieces.begin(), view_.pieces.end(), [](const auto& p) {
      return p.verdict != PieceVerdict::kVisible;
    });
    if (first == view_.pieces.end() || out_of_budget()) {
      return first == view_.pieces.end() ? nullptr : hidden_piece();
    }
    if (first->final && ends_known()) {
      // The first one, unless a level of detail leaves a piece before it undecided.
      return hidden_piece();
    }
    std::vector<Stretch> stretches = stretch_to_first_hidden();
    refine(std::move(stretches), kEverything, 0.0);
  }
}

/// The stretches from the first piece that may hide the line to the first piece that does.
/// Deviations are asked for in steps of a quarter, so that little is refined behind the place that
/// is looked for.
std::vector<SightPredicate::Stretch> SightSearch::stretch_to_first_hidden() const {
  std::vector<Stretch> stretches;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kVisible) {
      continue;
    }
    if (!p.final) {
      add(stretches, p.from, p.to,
          p.verdict == PieceVerdict::kHidden ? quarter_of(p.deviation)
                                             : target(p.guess, p.deviation));
    }
    if (p.verdict == PieceVerdict::kHidden) {
      break;
    }
  }
  cut_below_line(stretches, 0.0);
  return stretches;
}

void SightSearch::find_least_clearance() {
  double most = kInfinity;
  // Records that were left out because they end below the line may matter now. Where the line is
  // hidden they do not: then only what is above the line does.
  if (hidden_piece() == nullptr) {
    std::erase_if(view_.known, [](const KnownStretch& k) { return k.margin < kInfinity; });
    look();
  }
  while (true) {
    for (const SightPiece& p : view_.pieces) {
      most = std::min(most, p.most);
    }
    std::vector<Stretch> stretches = stretches_of_least(most);
    if (stretches.empty() || out_of_budget()) {
      return;
    }
    refine(std::move(stretches), kEverything, std::max(most, 0.0));
  }
}

/// The stretches of the pieces that may hold a smaller clearance than `most`.
std::vector<SightPredicate::Stretch> SightSearch::stretches_of_least(double most) const {
  std::vector<Stretch> stretches;
  for (const SightPiece& p : view_.pieces) {
    if (!p.final && p.least < most) {
      add(stretches, p.from, p.to, p.surface ? quarter_of(p.deviation) : kEverything);
    }
  }
  cut_below_line(stretches, most);
  return stretches;
}

}  // namespace ptin
