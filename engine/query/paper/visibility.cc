// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/visibility.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

constexpr double kEverything = -1.0;  ///< As a deviation: no record is left out.

}  // namespace

SightSearch::SightSearch(const OpenedTerrain& terrain, const SightFacts& facts,
                         const SightRequest& request, const SightView& line, QueryContext& context)
    : facts_(facts),
      request_(request),
      context_(context),
      step_(std::max((facts.max_height - facts.min_height) / 4096,
                     facts.heights.type == HeightType::int32 ? facts.heights.step : 0.0)),
      mesh_(terrain, *facts.detail),
      view_(line) {
  view_.look(mesh_);
}

/// Of absolute ends only the states are asked, and only voids can change a state.
bool SightSearch::ends_known() const noexcept {
  return (view_.a.known && view_.b.known) || (request_.absolute && !facts_.has_voids);
}

bool SightSearch::out_of_budget() const noexcept {
  return request_.budget && context_.cost.records_retrieved >= *request_.budget;
}

void SightSearch::finish_ends() {
  if (!ends_known() && !out_of_budget()) {
    refine({}, kEverything);
  }
}

/// With all records at once, or with a budget step by step, so that the last step alone overruns
/// it.
void SightSearch::finish_line() {
  while (!out_of_budget()) {
    std::vector<Stretch> stretches;
    for (const SightPiece& p : view_.pieces) {
      if (!p.final) {
        add(stretches, p.from, p.to,
            request_.budget ? target(kInfinity, p.deviation / 2) : kEverything);
      }
    }
    if (stretches.empty()) {
      return;
    }
    refine(std::move(stretches), kEverything);
  }
}

/// Adds the records that the stretches and ends ask for, notes in `known` what is applied, and
/// looks again.
void SightSearch::refine(std::vector<Stretch> stretches, double end_deviation) {
  const bool asks_ends = !ends_known();
  const double ends = asks_ends ? end_deviation : kInfinity;
  for (const Stretch& s : stretches) {
    view_.known.push_back({s.from, s.to, s.deviation, s.beyond || !facts_.is_level_asked});
  }
  const SightPredicate wanted(view_.p(), view_.q(), std::move(stretches), ends,
                              facts_.detail->tolerance());
  const SightPredicate beyond = wanted.beyond();
  mesh_.refine(wanted, context_, facts_.is_level_asked ? &beyond : nullptr);
  if (asks_ends) {
    view_.end_deviation = std::min(view_.end_deviation, ends);
    view_.a.known = view_.b.known = view_.end_deviation < 0;
  }
  view_.look(mesh_);
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

/// Adds a stretch; joins it to the last one where it follows that.
void SightSearch::add(std::vector<Stretch>& stretches, double from, double to,
                      double deviation) const {
  if (!stretches.empty() && stretches.back().to == from) {
    Stretch& last = stretches.back();
    last.to = to;
    last.deviation = std::min(last.deviation, deviation);
  } else {
    stretches.push_back({from, to, deviation});
  }
}

SightVerdict SightSearch::decide() {
  while (true) {
    if (view_.hidden_piece() != nullptr || view_.is_touched_from_below()) {
      return SightVerdict::kHidden;
    }
    const bool undecided = std::any_of(view_.pieces.begin(), view_.pieces.end(), [](const auto& p) {
      return p.verdict == PieceVerdict::kUndecided;
    });
    if (!undecided && !view_.open_touch()) {
      return view_.may_be_touched_from_below() ? SightVerdict::kUndecided : SightVerdict::kVisible;
    }
    if (out_of_budget()) {
      return SightVerdict::kUndecided;
    }
    std::vector<Stretch> stretches = undecided_stretches();
    if (stretches.empty() && ends_known()) {
      stretches = undecided ? unsettled_stretch() : open_touch();
      if (stretches.empty()) {
        return SightVerdict::kUndecided;  // neither the file nor the level of detail says more
      }
    }
    double ends = kInfinity;
    for (const Stretch& s : stretches) {
      ends = std::min(ends, s.deviation);
    }
    refine(std::move(stretches), std::isinf(ends) ? kEverything : ends);
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
  if (likely != nullptr) {
    const double deviation =
        facts_.has_voids ? kEverything : target(likely->guess, likely->deviation);
    return {{likely->guess_at, likely->guess_at, deviation}};
  }
  std::vector<Stretch> stretches;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kUndecided && !p.final) {
      add(stretches, p.from, p.to, p.surface ? target(p.guess, p.deviation) : kEverything);
    }
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
  return {{likely->guess_at, likely->guess_at, kEverything, true}};
}

/// The point of which the classes are open; empty when the file does not know them either.
std::vector<SightPredicate::Stretch> SightSearch::open_touch() const {
  const double share = *view_.open_touch();
  const bool is_known = std::any_of(view_.known.begin(), view_.known.end(), [&](const auto& k) {
    return k.deviation < 0 && k.beyond && k.from <= share && share <= k.to;
  });
  return is_known ? std::vector<Stretch>{}
                  : std::vector<Stretch>{{share, share, kEverything, true}};
}

}  // namespace ptin
