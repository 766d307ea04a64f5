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
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/sight/fresnel.h"
#include "engine/query/sight/sight_search.h"

namespace ptin {

namespace {

[[noreturn]] void throw_invalid(const std::string& what) {
  throw Error(ErrorCode::invalid_argument, what);
}

void check(const SightRequest& r) {
  ptin::check(r.curvature);
  if (!(r.wavelength >= 0) || !std::isfinite(r.wavelength)) {
    throw_invalid("the wavelength is negative or not finite");
  }
}

/// The error that about `records` records exceed, by the file's table; infinite when none do.
double error_of_first(const StoreFile& store, std::uint64_t records) {
  double error = kInfinity;
  std::uint64_t above = 0;
  const auto bins = store.error_bins();
  for (std::size_t i = bins.size(); i-- > 0 && above < records;) {
    error = i == 0 ? 0.0 : bins[i - 1].upper;
    above += bins[i].records;
  }
  return error;
}

class DeviationAbove final : public AttributePredicate {
 public:
  DeviationAbove(double deviation, double tolerance)
      : deviation_(deviation), tolerance_(tolerance) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.deviation > deviation_ && a.error > tolerance_;
  }

 private:
  double deviation_, tolerance_;
};

/// Where the clearance first falls to zero in a piece that hides the line: at its beginning, or the
/// first root of the parabola c(t) = c0 + (c1 - c0 - bend) t + bend t^2, t from 0 to 1.
double first_below(const SightView& view, const SightPiece& piece) {
  const double width = piece.to - piece.from;
  const double c0 = view.ray().middle(piece.from) - piece.ground_from;
  const double c1 = view.ray().middle(piece.to) - piece.ground_to;
  const double bend = view.bend * width * width;
  const double slope = c1 - c0 - bend;
  const double root = std::sqrt(std::max(0.0, slope * slope - 4 * bend * c0));
  const double t = c0 > 0 && root - slope > 0 ? std::min(1.0, 2 * c0 / (root - slope)) : 0.0;
  return piece.from + t * width;
}

/// True when every piece before `hidden` is visible and `hidden` is what it is in the full TIN.
/// Without a hidden piece, where a vertex alone hides the line: when all pieces are visible.
bool is_first_for_certain(const SightView& view, const SightPiece* hidden) {
  const auto first = std::find_if(view.pieces.begin(), view.pieces.end(), [](const auto& p) {
    return p.verdict != PieceVerdict::kVisible;
  });
  return first == view.pieces.end() ? hidden == nullptr
                                    : &*first == hidden && is_final_truth(*hidden);
}

bool is_true_everywhere(const SightView& view) {
  return std::all_of(view.pieces.begin(), view.pieces.end(), is_final_truth);
}

}  // namespace

class SightSolver::Impl {
 public:
  Impl(const OpenedTerrain& terrain, SightRequest request, std::uint64_t base_records);
  SightResult solve(const SightPair& pair);

  QueryCost base_cost;

 private:
  /// Meshes larger than the coarse one by this many vertices are given up.
  static constexpr std::size_t kMostExtra = std::size_t{1} << 16;

  [[nodiscard]] Spot spot_of_end(MapPoint p, double height) const;
  [[nodiscard]] double ground_length(const SightPair& pair) const;
  void renew_mesh();
  void answer(const SightPair& pair, Spot p, Spot q, QueryContext& context, SightResult& result);
  void answer_defined(SightSearch& search, const SightPair& pair, SightResult& result);
  void answer_upright(const SightPair& pair, SightResult& result);
  bool measure(SightSearch& search, const SightPair& pair, SightResult& result);
  void set_clearance(const SightView& view, const SightPair& pair, SightResult& result) const;
  void measure_line(const SightView& view, const SightPair& pair, SightResult& result) const;
  void state_ends(const SightView& view, SightResult& result) const;
  [[nodiscard]] SightPoint point_at(const SightPair& pair, const SightView& view, double share,
                                    double length) const;

  const OpenedTerrain terrain_;
  SightRequest request_;
  StoreFacts store_facts_;
  SightFacts facts_;
  SpotMap map_;
  double step_ = 0.0;
  Detail detail_;
  std::optional<BoundedMesh> base_;  ///< The coarse mesh, as it was built.
  std::optional<BoundedMesh> mesh_;
  std::size_t base_vertices_ = 0;
  bool is_spoilt_ = false;  ///< An error came while the mesh was changed.
};

SightSolver::Impl::Impl(const OpenedTerrain& terrain, SightRequest request,
                        std::uint64_t base_records)
    : terrain_(terrain),
      request_(std::move(request)),
      store_facts_(terrain.store().facts()),
      map_(store_facts_.map, store_facts_.bounds),
      detail_(terrain.store()) {
  check(request_);
  const StoreFile& store = terrain.store();
  QueryContext context(request_.limits, store.path());
  detail_ = Detail(request_.detail, terrain.record_source(), context);
  facts_.tolerance = detail_.tolerance();
  facts_.is_level_asked = detail_.is_asked();
  facts_.heights = store_facts_.heights;
  const Certificate finest = detail_.certificate();
  facts_.file_deviation = store_facts_.base_deviation;
  facts_.finest_deviation = finest.deviation;
  facts_.max_height = store_facts_.max_height;
  facts_.has_voids = !store.facts().free_of_voids;
  // A certified error of 0 does not settle the voids: they may differ between samples.
  facts_.exact_settles = !facts_.has_voids || store_facts_.base_error == 0;
  facts_.final_settles = facts_.exact_settles && (!facts_.has_voids || finest.complete);
  facts_.base_deviation = kInfinity;
  const double range = std::max(0.0, store_facts_.max_height - store_facts_.min_height);
  step_ =
      std::max(range / 4096,
               store_facts_.heights.type == HeightType::int32 ? store_facts_.heights.step : 0.0);
  base_.emplace(terrain_, detail_);
  if (base_records > 0) {
    facts_.base_deviation = error_of_first(store, base_records);
    base_->refine(DeviationAbove(facts_.base_deviation, facts_.tolerance), context);
    if (detail_.is_asked()) {
      facts_.base_deviation = std::max(facts_.base_deviation, facts_.finest_deviation);
    }
  }
  base_cost = context.cost;
  base_vertices_ = base_->tin().vertices.size();
  mesh_.emplace(*base_);
}

void SightSolver::Impl::renew_mesh() {
  if (is_spoilt_ || mesh_->tin().vertices.size() > base_vertices_ + kMostExtra) {
    mesh_.emplace(*base_);
    is_spoilt_ = false;
  }
}

Spot SightSolver::Impl::spot_of_end(MapPoint p, double height) const {
  constexpr double kMost = 1e30;  // differences and products of such heights are finite
  if (!(std::abs(height) <= kMost)) {
    throw_invalid("the height of an end is not a finite number, or beyond 1e30");
  }
  const std::optional<Spot> spot = map_.spot(p);
  if (!spot) {
    throw_invalid("an end lies too far from the terrain: give map units of its CRS");
  }
  return *spot;
}

double SightSolver::Impl::ground_length(const SightPair& pair) const {
  const double length = request_.ground_distance
                            ? request_.ground_distance(pair.a, pair.b)
                            : std::sqrt((pair.b.x - pair.a.x) * (pair.b.x - pair.a.x) +
                                        (pair.b.y - pair.a.y) * (pair.b.y - pair.a.y));
  if (!std::isfinite(length)) {
    throw_invalid("the distance between the ends is not known: they may lie off the ellipsoid");
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
    answer_upright(pair, result);
  } else {
    renew_mesh();
    is_spoilt_ = true;
    answer(pair, p, q, context, result);
    is_spoilt_ = false;
    result.cost = context.cost;
  }
  terrain_.store().pages().check_unchanged();
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void SightSolver::Impl::answer(const SightPair& pair, Spot p, Spot q, QueryContext& context,
                               SightResult& result) {
  result.length = ground_length(pair);
  const double bend = request_.curvature.drop_at(result.length);
  SightSearch search(facts_, request_, *mesh_, context, step_);
  search.begin(p, q, pair, bend, 0);
  if (facts_.has_voids) {
    search.finish_ends();
  }
  state_ends(search.view(), result);
  const bool is_certain = !facts_.has_voids || search.ends_known();
  if (search.view().ends_defined() && (is_certain || request_.absolute)) {
    answer_defined(search, pair, result);
  } else if (is_certain) {
    result.verdict = SightVerdict::kUndefined;
    result.exact = store_facts_.base_error == 0;
  } else {
    result.certified_deviation = kInfinity;  // the budget did not reach the ends
  }
}

void SightSolver::Impl::answer_defined(SightSearch& search, const SightPair& pair,
                                       SightResult& result) {
  const bool whole_line = !request_.verdict_only && (facts_.has_voids || request_.wavelength > 0);
  if (whole_line) {
    search.finish_line();
  }
  result.verdict = search.decide();
  bool measured = true;
  if (request_.verdict_only) {
    if (const SightPiece* hidden = search.hidden_piece(); hidden != nullptr) {
      result.obstruction = point_at(pair, search.view(), hidden->guess_at, result.length);
    }
  } else {
    measured = measure(search, pair, result);
  }
  for (const SightPiece& piece : search.view().pieces) {
    if (result.verdict == SightVerdict::kUndecided && piece.verdict == PieceVerdict::kUndecided) {
      result.certified_deviation = std::max(result.certified_deviation, piece.deviation);
    }
  }
  result.exact =
      store_facts_.base_error == 0 && result.verdict != SightVerdict::kUndecided && measured;
}

/// Both ends at one place: the line is upright, and hidden as far as it lies under ground.
void SightSolver::Impl::answer_upright(const SightPair& pair, SightResult& result) {
  if (request_.budget && *request_.budget == 0) {
    result.certified_deviation = kInfinity;
    return;
  }
  LocateRequest request;  // no level of detail: the ground below ends is always exact
  request.limits = request_.limits;
  const LocateResult located = locate(terrain_, {&pair.a, 1}, request);
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
  result.verdict = result.clearance_min >= 0  ? SightVerdict::kVisible
                   : result.clearance_max < 0 ? SightVerdict::kHidden
                                              : SightVerdict::kUndecided;
  if (result.verdict == SightVerdict::kUndecided) {
    result.certified_deviation = located.certified_deviation;
  }
  const double height = request_.absolute ? lower : ground.height + lower;
  result.clearance_at = SightPoint{pair.a, 0.0, 0.0, height};
  if (result.verdict == SightVerdict::kHidden) {
    result.obstruction = result.clearance_at;
  }
}

void SightSolver::Impl::state_ends(const SightView& view, SightResult& result) const {
  const auto state = [](const SightEnd& end) {
    return !end.inside ? PointState::kOutside
                       : (end.surface ? PointState::kSurface : PointState::kVoid);
  };
  result.state_a = state(view.a);
  result.state_b = state(view.b);
}

SightPoint SightSolver::Impl::point_at(const SightPair& pair, const SightView& view, double share,
                                       double length) const {
  return {{pair.a.x + share * (pair.b.x - pair.a.x), pair.a.y + share * (pair.b.y - pair.a.y)},
          share,
          share * length,
          view.ray().middle(share)};
}

/// Measures the first obstruction, the smallest clearance, and what runs along the whole line
/// (voids, the Fresnel zone).
/// @returns whether all of that is as in the full TIN
bool SightSolver::Impl::measure(SightSearch& search, const SightPair& pair, SightResult& result) {
  search.finish_ends();
  bool is_true = !facts_.has_voids || search.ends_known();
  if (result.verdict == SightVerdict::kHidden) {
    const SightPiece* hidden = search.find_first_hidden();
    const SightView& view = search.view();
    const double share = hidden != nullptr ? first_below(view, *hidden) : 2.0;
    is_true = is_true && is_first_for_certain(view, hidden) && view.knows_levels();
    if (std::min(share, view.touched_at()) <= 1.0) {
      result.obstruction = point_at(pair, view, std::min(share, view.touched_at()), result.length);
    }
  }
  if (request_.wavelength > 0 || facts_.has_voids) {
    measure_line(search.view(), pair, result);
  } else {
    result.void_length = 0.0;
  }
  search.find_least_clearance();
  set_clearance(search.view(), pair, result);
  return is_true && !(result.clearance_min < result.clearance_max) &&
         std::isfinite(result.void_length) &&
         (request_.wavelength == 0 || is_true_everywhere(search.view()));
}

void SightSolver::Impl::set_clearance(const SightView& view, const SightPair& pair,
                                      SightResult& result) const {
  Lowest lowest = view.least_touch();
  double least = lowest.value;
  double most = lowest.value;
  for (const SightPiece& p : view.pieces) {
    least = std::min(least, p.least);
    most = std::min(most, p.most);
    if (p.surface && p.guess < lowest.value) {
      lowest = {p.guess, p.guess_at};
    }
  }
  if (view.pieces.empty() || !std::isfinite(lowest.value)) {
    return;
  }
  const bool known = view.ray().is_known() &&
                     std::none_of(view.pieces.begin(), view.pieces.end(), [&](const auto& p) {
                       return p.least < most && !is_final_truth(p);
                     });
  result.clearance_min = known ? lowest.value : least;
  result.clearance_max = known ? lowest.value : most;
  result.clearance_at = point_at(pair, view, lowest.at, result.length);
}

void SightSolver::Impl::measure_line(const SightView& view, const SightPair& pair,
                                     SightResult& result) const {
  double voids = 0.0;
  bool whole = true;  // every piece is final; else the budget ended first
  LeastRatio least{kInfinity, 0.0};
  for (const SightPiece& p : view.pieces) {
    if (facts_.has_voids && !p.settled) {
      voids = std::numeric_limits<double>::quiet_NaN();
    }
    whole = whole && p.final;
    if (!p.surface) {
      voids += (p.to - p.from) * result.length;
      continue;
    }
    const LeastRatio ratio =
        least_fresnel_ratio(p.from, view.ray().middle(p.from) - p.ground_from, p.to,
                            view.ray().middle(p.to) - p.ground_to, view.bend);
    least = ratio.ratio < least.ratio ? ratio : least;
  }
  result.void_length = voids;
  if (request_.wavelength > 0 && whole && least.ratio < kInfinity) {
    // The zone's radius is sqrt(wavelength d1 d2 / (d1 + d2)) with d1 = s L, d2 = (1 - s) L.
    result.fresnel_ratio = least.ratio / std::sqrt(request_.wavelength * result.length);
    result.fresnel_at = point_at(pair, view, least.at, result.length);
  }
}

SightSolver::SightSolver(const OpenedTerrain& terrain, SightRequest request,
                         std::uint64_t base_records)
    : impl_(std::make_unique<Impl>(terrain, std::move(request), base_records)) {}
SightSolver::~SightSolver() = default;
SightSolver::SightSolver(SightSolver&&) noexcept = default;
SightSolver& SightSolver::operator=(SightSolver&&) noexcept = default;

const QueryCost& SightSolver::base_cost() const noexcept { return impl_->base_cost; }

SightResult SightSolver::solve(const SightPair& pair) { return impl_->solve(pair); }

SightResult sight(const OpenedTerrain& terrain, const SightPair& pair,
                  const SightRequest& request) {
  SightSolver solver(terrain, request, 0);
  SightResult result = solver.solve(pair);
  result.cost.add_counts(solver.base_cost());
  return result;
}

}  // namespace ptin
