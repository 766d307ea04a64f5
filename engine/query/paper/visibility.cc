// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/visibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/paper/point_location.h"
#include "engine/query/paper/selective_refinement.h"
#include "engine/query/sight/sight_search.h"
#include "engine/query/sight/sight_view.h"

namespace ptin::paper {

namespace {

constexpr double kEverything = -1.0;  ///< As a deviation: no record is left out.

/// What is asked for of a stretch of the line; of stretches that were refined, what is there.
using Stretch = KnownStretch;

/// A box around the stretch, at least one grid unit wider on each side, which is more than rounding
/// needs.
GridBox box_around(Spot p, Spot q, const Stretch& s) noexcept {
  const auto whole = [](double v) {
    return static_cast<std::int32_t>(std::clamp(v, -2147483648.0, 2147483647.0));
  };
  const MapPoint a = grid_of(p);
  const MapPoint b = grid_of(q);
  const auto [x0, x1] = std::minmax({a.x + s.from * (b.x - a.x), a.x + s.to * (b.x - a.x)});
  const auto [y0, y1] = std::minmax({a.y + s.from * (b.y - a.y), a.y + s.to * (b.y - a.y)});
  return {whole(std::floor(x0) - 1), whole(std::floor(y0) - 1), whole(std::ceil(x1) + 1),
          whole(std::ceil(y1) + 1)};
}

/// What the line still needs to know. True for a record in two cases. Near a stretch: the roi meets
/// the stretch, the deviation is too large for it, and the error is above the tolerance unless the
/// stretch goes beyond it. At an end: the roi holds the end, and the deviation is too large for the
/// ends, whatever the tolerance. Monotone: exact integers and comparisons.
class NeededAlongLine final : public AttributePredicate {
 public:
  /// @param end_deviation  As Stretch::deviation, for records at p and q; infinite: none are wanted
  ///                       there.
  NeededAlongLine(Spot p, Spot q, std::vector<Stretch> stretches, double end_deviation,
                  double tolerance)
      : p_(p),
        q_(q),
        stretches_(std::move(stretches)),
        end_deviation_(end_deviation),
        tolerance_(tolerance) {
    for (const Stretch& s : stretches_) {
      around_.push_back(box_around(p, q, s));
      whole_ = united(whole_, around_.back());
    }
  }

  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    if (a.deviation > end_deviation_ && (contains(a.roi, p_) || contains(a.roi, q_))) {
      return true;
    }
    if (!meets(a.roi, whole_) || !line_meets(p_, q_, a.roi)) {
      return false;
    }
    for (std::size_t i = 0; i < stretches_.size(); ++i) {
      const Stretch& s = stretches_[i];
      if (a.deviation > s.deviation && (a.error > tolerance_ || s.beyond) &&
          meets(a.roi, around_[i])) {
        return true;
      }
    }
    return false;
  }

  /// The part that goes beyond the level of detail: the ends, and the stretches with `beyond`.
  [[nodiscard]] NeededAlongLine beyond() const {
    std::vector<Stretch> stretches;
    std::copy_if(stretches_.begin(), stretches_.end(), std::back_inserter(stretches),
                 [](const Stretch& s) { return s.beyond; });
    return {p_, q_, std::move(stretches), end_deviation_, tolerance_};
  }

 private:
  Spot p_, q_;
  std::vector<Stretch> stretches_;
  std::vector<GridBox> around_;  ///< For each stretch a box around it, rounded outward.
  GridBox whole_;                ///< Around all of them.
  double end_deviation_, tolerance_;
};

/// The three steps of section 5.3: walk over the triangles below the line; compare the line with
/// minh(t) and maxh(t) of each (SightLine::decide_by_bounds()); refine those for which that leaves
/// open whether they occlude q, the ones close to the critical values first; begin again.
class VisibilityQuery final : public SightSearch {
 public:
  VisibilityQuery(const OpenedTerrain& terrain, const SightFacts& facts,
                  const SightRequest& request, const SightLine& line, QueryContext& context)
      : SightSearch(facts, request, context),
        // A 4096th of the relief, or a step of stored heights.
        step_(std::max((facts.max_height - facts.min_height) / 4096,
                       facts.heights.type == HeightType::int32 ? facts.heights.step : 0.0)),
        mesh_(terrain, *facts.detail),
        view_(line) {
    view_.look(mesh_);
  }

  [[nodiscard]] const SightLine& line() const noexcept override { return view_; }
  void finish_line() override;
  [[nodiscard]] SightVerdict decide() override;

 private:
  void find_ends() override { refine({}, kEverything); }
  [[nodiscard]] double target(double margin, double deviation) const noexcept;
  [[nodiscard]] std::vector<Stretch> undecided_stretches() const;
  [[nodiscard]] std::vector<Stretch> unsettled_stretch() const;
  [[nodiscard]] std::vector<Stretch> open_touch() const;
  template <class IsWanted>
  [[nodiscard]] const SightPiece* lowest_piece(const IsWanted& is_wanted) const;
  void refine(std::vector<Stretch> stretches, double end_deviation);

  double step_;  ///< Deviations below this are not worth a search of their own.
  SelectiveRefinement mesh_;
  SightView view_;
};

/// Adds a piece of the line; joins it to the last stretch where it follows that.
void add(std::vector<Stretch>& stretches, const SightPiece& piece, double deviation) {
  if (!stretches.empty() && stretches.back().to == piece.from) {
    stretches.back().to = piece.to;
    stretches.back().deviation = std::min(stretches.back().deviation, deviation);
  } else {
    stretches.push_back({piece.from, piece.to, deviation});
  }
}

/// With all records at once, or with a budget step by step, so that the last step alone overruns
/// it.
void VisibilityQuery::finish_line() {
  while (!out_of_budget()) {
    std::vector<Stretch> stretches;
    for (const SightPiece& p : view_.pieces) {
      if (!p.final) {
        add(stretches, p, request_.budget ? target(kInfinity, p.deviation / 2) : kEverything);
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
void VisibilityQuery::refine(std::vector<Stretch> stretches, double end_deviation) {
  const bool asks_ends = !ends_known();
  const double ends = asks_ends ? end_deviation : kInfinity;
  for (const Stretch& s : stretches) {
    view_.known.push_back({s.from, s.to, s.deviation, s.beyond || !facts_.is_level_asked});
  }
  const NeededAlongLine needed(view_.p(), view_.q(), std::move(stretches), ends,
                               facts_.detail->tolerance());
  const NeededAlongLine beyond = needed.beyond();
  mesh_.refine(needed, context_, facts_.is_level_asked ? &beyond : nullptr);
  if (asks_ends) {
    view_.end_deviation = std::min(view_.end_deviation, ends);
    view_.a.known = view_.b.known = view_.end_deviation < 0;
  }
  view_.look(mesh_);
}

/// The deviation to ask for, so that a piece is likely to be decided whose clearance is `margin`
/// and whose deviation is `deviation`: at most half of that deviation. Every record is asked for
/// where the deviation wanted would be too small for a search of its own.
double VisibilityQuery::target(double margin, double deviation) const noexcept {
  // Where nothing is known, over T0, the margin is infinite: a first look asks for a sixteenth of
  // the relief (256 steps). An end that may still rise or fall takes a part of the margin.
  const double share = ends_known() ? 0.7 : 0.45;
  const double wanted = std::isfinite(margin) ? std::min(share * std::abs(margin), 0.5 * deviation)
                                              : std::min(0.5 * deviation, 256 * step_);
  return wanted > std::max(step_, facts_.finest_deviation) ? wanted : kEverything;
}

SightVerdict VisibilityQuery::decide() {
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

/// The undecided piece of surface that is wanted and lies lowest below the mesh; null: there is none.
template <class IsWanted>
const SightPiece* VisibilityQuery::lowest_piece(const IsWanted& is_wanted) const {
  const SightPiece* lowest = nullptr;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kUndecided && p.surface && is_wanted(p) &&
        (lowest == nullptr || p.guess < lowest->guess)) {
      lowest = &p;
    }
  }
  return lowest;
}

/// What to refine next. If the mesh rises above the line somewhere: the one point that is most
/// likely to hide the line. Else all undecided pieces, since each of them must turn out visible.
std::vector<Stretch> VisibilityQuery::undecided_stretches() const {
  const SightPiece* likely =
      lowest_piece([](const SightPiece& p) { return !p.final && p.guess < 0; });
  if (likely != nullptr) {
    const double deviation =
        facts_.has_voids ? kEverything : target(likely->guess, likely->deviation);
    return {{likely->guess_at, likely->guess_at, deviation}};
  }
  std::vector<Stretch> stretches;
  for (const SightPiece& p : view_.pieces) {
    if (p.verdict == PieceVerdict::kUndecided && !p.final) {
      add(stretches, p, p.surface ? target(p.guess, p.deviation) : kEverything);
    }
  }
  return stretches;
}

/// The one point that hides the line unless it is a void, which only records beyond the level of
/// detail decide; empty when there is none.
std::vector<Stretch> VisibilityQuery::unsettled_stretch() const {
  const SightPiece* likely = lowest_piece([this](const SightPiece& p) {
    return facts_.has_voids && !p.exact && p.guess < -p.deviation;
  });
  return likely == nullptr
             ? std::vector<Stretch>{}
             : std::vector<Stretch>{{likely->guess_at, likely->guess_at, kEverything, true}};
}

/// The point of which the classes are open; empty when the file does not know them either.
std::vector<Stretch> VisibilityQuery::open_touch() const {
  const double share = *view_.open_touch();
  const bool is_known = std::any_of(view_.known.begin(), view_.known.end(), [&](const auto& k) {
    return k.deviation < 0 && k.beyond && k.from <= share && share <= k.to;
  });
  return is_known ? std::vector<Stretch>{}
                  : std::vector<Stretch>{{share, share, kEverything, true}};
}

}  // namespace

SightSolver sight_lines(const OpenedTerrain& terrain, const SightRequest& request) {
  const auto begin = [](const OpenedTerrain& t, const SightFacts& facts, const SightRequest& asked,
                        const SightLine& line,
                        QueryContext& context) -> std::unique_ptr<SightSearch> {
    return std::make_unique<VisibilityQuery>(t, facts, asked, line, context);
  };
  return {terrain, request, SightWay{begin, &locate}};
}

}  // namespace ptin::paper
