// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/living/triangle_at.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/total_order.h"
#include "engine/query/sight/sight_measure.h"
#include "engine/query/sight/sight_stars.h"

namespace ptin {

namespace {

void check(const SightRequest& r) {
  ptin::check(r.curvature);
  if (!(r.wavelength >= 0) || !std::isfinite(r.wavelength)) {
    refuse("the wavelength is negative or not finite");
  }
}

/// Sign of a height above the ground at a located point of surface, in rationals.
int sign_above(double height, const LocatedPoint& ground, const HeightEncoding& heights, Spot at) {
  LivingTriangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const LocatedPoint::Corner& c = ground.triangle[i];
    const double code = (c.height - heights.offset) / heights.step;
    triangle.corner[i] = {c.position,
                          heights.bits(heights.type == HeightType::int32 ? std::round(code) : code),
                          true};
  }
  const ExactRay ray(heights, {height, nullptr}, {height, nullptr}, 0.0);
  return ray.sign_at({codes_in(triangle, heights, at), 0, 1});
}

}  // namespace

class SightSolver::Impl {
 public:
  /// @param way  None: by the triangles that live at the level.
  Impl(const OpenedTerrain& terrain, SightRequest request, std::uint64_t coarse_records,
       std::optional<SightWay> way);
  SightResult solve(const SightPair& pair);

  QueryCost base_cost;

 private:
  [[nodiscard]] Spot spot_of_end(MapPoint p, double height) const;
  [[nodiscard]] double ground_length(const SightPair& pair) const;
  [[nodiscard]] std::unique_ptr<SightSearch> search_along(const SightLine& line,
                                                          QueryContext& context) const;
  void answer(SightSearch& search, const SightPair& pair, SightResult& result) const;
  void answer_defined(SightSearch& search, const SightPair& pair, SightResult& result) const;
  void answer_upright(const SightPair& pair, Spot at, SightResult& result) const;

  const OpenedTerrain terrain_;
  SightRequest request_;
  std::optional<SightWay> way_;
  StoreFacts store_facts_;
  SightFacts facts_;
  SpotMap map_;
  Detail detail_;
  std::optional<CoarseGround> coarse_;
};

SightSolver::Impl::Impl(const OpenedTerrain& terrain, SightRequest request,
                        std::uint64_t coarse_records, std::optional<SightWay> way)
    : terrain_(terrain),
      request_(std::move(request)),
      way_(way),
      store_facts_(terrain.store().facts()),
      map_(store_facts_.map, store_facts_.bounds),
      detail_(terrain.store()) {
  check(request_);
  const StoreFile& store = terrain.store();
  QueryContext context(request_.limits, store.path());
  detail_ = Detail(request_.detail, terrain.record_source(), context);
  facts_.detail = &detail_;
  facts_.is_level_asked = detail_.is_asked() && !detail_.certificate().complete;
  facts_.heights = store_facts_.heights;
  const Certificate finest = detail_.certificate();
  facts_.file_deviation = store_facts_.base_deviation;
  facts_.finest_deviation = finest.deviation;
  facts_.min_height = store_facts_.min_height;
  facts_.max_height = store_facts_.max_height;
  facts_.has_voids = !store_facts_.free_of_voids;
  // A certified error of 0 does not settle the voids: they may differ between samples. Rounded heights move none.
  facts_.exact_settles = !facts_.has_voids || !leaves_records_out(store_facts_);
  facts_.final_settles = facts_.exact_settles && (!facts_.has_voids || finest.complete);
  if (coarse_records > 0 && request_.verdict_only) {
    const double error = bound_exceeded_by(store.error_bins(), coarse_records);
    coarse_.emplace(terrain_, std::max({error, detail_.tolerance(), 0.0}), context);
  }
  base_cost = context.cost;
}

Spot SightSolver::Impl::spot_of_end(MapPoint p, double height) const {
  constexpr double kMost = 1e30;  // differences and products of such heights are finite
  if (!(std::abs(height) <= kMost)) {
    refuse("the height of an end is not a finite number, or beyond 1e30");
  }
  const std::optional<Spot> spot = map_.spot(p);
  if (!spot) {
    refuse("an end lies too far from the terrain: give map units of its CRS");
  }
  return *spot;
}

double SightSolver::Impl::ground_length(const SightPair& pair) const {
  const double length = request_.ground_distance
                            ? request_.ground_distance(pair.a, pair.b)
                            : std::sqrt((pair.b.x - pair.a.x) * (pair.b.x - pair.a.x) +
                                        (pair.b.y - pair.a.y) * (pair.b.y - pair.a.y));
  if (!std::isfinite(length)) {
    refuse("the distance between the ends is not known: they may lie off the ellipsoid");
  }
  return length;
}

SightResult SightSolver::Impl::solve(const SightPair& pair) {
  const auto start = std::chrono::steady_clock::now();
  QueryContext context(request_.limits, terrain_.store().path());
  context.check_stop();
  const Spot p = spot_of_end(pair.a, pair.height_a);
  const Spot q = spot_of_end(pair.b, pair.height_b);
  SightResult result;
  if (p == q) {
    answer_upright(pair, p, result);
  } else {
    result.length = ground_length(pair);
    const double bend = request_.curvature.drop_at(result.length);
    const SightLine line(facts_, p, q, pair, request_.absolute, bend);
    answer(*search_along(line, context), pair, result);
    result.cost = context.cost;
  }
  terrain_.store().pages().check_unchanged();
  result.cost.seconds = seconds_since(start);
  return result;
}

std::unique_ptr<SightSearch> SightSolver::Impl::search_along(const SightLine& line,
                                                             QueryContext& context) const {
  if (way_) {
    return way_->search(terrain_, facts_, request_, line, context);
  }
  return std::make_unique<SightStars>(terrain_, facts_, request_, coarse_ ? &*coarse_ : nullptr,
                                      line, context);
}

void SightSolver::Impl::answer(SightSearch& search, const SightPair& pair,
                               SightResult& result) const {
  if (facts_.has_voids || !request_.verdict_only) {
    search.finish_ends();
  }
  const bool is_certain = !facts_.has_voids || search.ends_known();
  result.state_a = state_of(search.line().a);
  result.state_b = state_of(search.line().b);
  if (search.line().ends_defined() && (is_certain || request_.absolute)) {
    answer_defined(search, pair, result);
    result.exact = result.exact && is_certain;  // the states of the ends are a part of the answer
  } else if (is_certain) {
    result.verdict = SightVerdict::kUndefined;
    result.exact = store_facts_.base_error == 0;
  } else {
    result.certified_deviation = kInfinity;  // the budget did not reach the ends
  }
}

void SightSolver::Impl::answer_defined(SightSearch& search, const SightPair& pair,
                                       SightResult& result) const {
  if (!request_.verdict_only) {
    search.finish_line();
  }
  result.verdict = search.decide();
  const SightLine& line = search.line();
  bool measured = true;
  if (!request_.verdict_only) {
    measured = measure(line, facts_, pair, request_.wavelength, result) &&
               (!facts_.has_voids || search.ends_known());
  } else if (const SightPiece* hidden = line.hidden_piece(); hidden != nullptr) {
    result.obstruction = point_at(pair, line, hidden->most_at, result.length);
  } else if (line.is_touched_from_below()) {
    result.obstruction = point_at(pair, line, line.touched_at(), result.length);
  }
  if (result.verdict == SightVerdict::kUndecided && line.may_be_touched_from_below()) {
    result.certified_deviation = facts_.file_deviation;
  }
  for (const SightPiece& piece : line.pieces) {
    if (result.verdict == SightVerdict::kUndecided && piece.verdict == PieceVerdict::kUndecided) {
      result.certified_deviation = std::max(result.certified_deviation, piece.deviation);
    }
  }
  result.exact =
      store_facts_.base_error == 0 && result.verdict != SightVerdict::kUndecided && measured;
}

/// Both ends at one place: the line is upright, and hidden as far as it lies under ground.
void SightSolver::Impl::answer_upright(const SightPair& pair, Spot at, SightResult& result) const {
  if (request_.budget && *request_.budget == 0) {
    result.certified_deviation = kInfinity;
    return;
  }
  LocateRequest request;  // no level of detail: the ground below ends is always exact
  request.limits = request_.limits;
  const auto locate_by = way_ ? way_->locate : &locate;
  const LocateResult located = locate_by(terrain_, {&pair.a, 1}, request);
  const LocatedPoint& ground = located.points[0];
  result.cost = located.cost;
  result.state_a = result.state_b = ground.state;
  result.exact = located.exact;
  result.void_length = 0.0;
  const double lower = std::min(pair.height_a, pair.height_b);
  if (ground.state != PointState::kSurface) {
    result.verdict = request_.absolute ? SightVerdict::kVisible : SightVerdict::kUndefined;
    return;
  }
  result.clearance_min = request_.absolute ? lower - ground.height_max : lower;
  result.clearance_max = request_.absolute ? lower - ground.height_min : lower;
  const bool is_known = ground.height_min == ground.height_max;
  if (request_.absolute && is_known) {
    result.verdict = sign_above(lower, ground, facts_.heights, at) < 0 ? SightVerdict::kHidden
                                                                       : SightVerdict::kVisible;
  } else {
    result.verdict = result.clearance_min >= 0  ? SightVerdict::kVisible
                     : result.clearance_max < 0 ? SightVerdict::kHidden
                                                : SightVerdict::kUndecided;
  }
  if (result.verdict == SightVerdict::kUndecided) {
    result.certified_deviation = located.certified_deviation;
  }
  const double height = request_.absolute ? lower : ground.height + lower;
  result.clearance_at = SightPoint{pair.a, 0.0, 0.0, height};
  if (result.verdict == SightVerdict::kHidden) {
    result.obstruction = result.clearance_at;
  }
}

SightSolver::SightSolver(const OpenedTerrain& terrain, SightRequest request,
                         std::uint64_t coarse_records)
    : impl_(std::make_unique<Impl>(terrain, std::move(request), coarse_records, std::nullopt)) {}
SightSolver::SightSolver(const OpenedTerrain& terrain, SightRequest request, SightWay way)
    : impl_(std::make_unique<Impl>(terrain, std::move(request), 0, way)) {}
SightSolver::~SightSolver() = default;
SightSolver::SightSolver(SightSolver&&) noexcept = default;
SightSolver& SightSolver::operator=(SightSolver&&) noexcept = default;

const QueryCost& SightSolver::base_cost() const noexcept { return impl_->base_cost; }

SightResult SightSolver::solve(const SightPair& pair) { return impl_->solve(pair); }

}  // namespace ptin
