// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/highest.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "engine/error.h"
#include "engine/query/refinement.h"
#include "engine/query/retrieval.h"
#include "engine/query/walk.h"
#include "storage/packed_rtree.h"

namespace ptin {

namespace {

constexpr std::size_t kStopInterval = 4096;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A vertex that may be among the highest. `value` is its code, negated when the lowest are wanted.
struct Candidate {
  double value;
  VertexKey key;
};

/// Gathers the best vertices and the records that reach above them.
class Gatherer final : public BestFirstVisitor {
 public:
  Gatherer(const ProgressiveTin& terrain, const HighestRequest& request,
           const AttributePredicate& predicate, const GridRegion* window, QueryContext& context)
      : store_(terrain.store()),
        request_(request),
        predicate_(predicate),
        window_(window),
        context_(context) {}

  /// Vertices that are none of the surface's: found again, they do not count.
  std::set<VertexKey> rejected;

  void start() {
    best_.clear();
    splits_.clear();
    bounds_.clear();
    for (const CoarsestTin::V& v : store_.t0().vertices) {
      if (v.has_height != 0) {
        offer(v.position, v.height);
      }
    }
  }

  [[nodiscard]] double bound(const Attributes& a) const override {
    if (!predicate_.holds(a) || is_empty(a.heights)) {
      return -kInfinity;
    }
    return request_.lowest ? -a.heights.lo : a.heights.hi;
  }

  double visit(PageId page) override {
    context_.check_stop();
    records_.clear();
    context_.cost.records_examined +=
        store_.read_matching(page, predicate_, records_, context_.cost.io);
    for (const VertexSplit& r : records_) {
      if ((r.flags & VertexSplit::kVertexVoid) == 0) {
        offer(r.u, r.height);
      }
      const double bound = this->bound(attributes_of(r, store_.facts().heights));
      if (bound > cut_off()) {
        splits_.push_back(pending_of(r, page));
        bounds_.push_back(bound);
      }
    }
    context_.admit(refinement_bytes(splits_.size()));
    // The next larger number: pages that reach no higher than the last of the best are not needed.
    return std::nextafter(cut_off(), kInfinity);
  }

  /// Nothing below or at this is wanted: the value of the last of the best.
  [[nodiscard]] double cut_off() const noexcept {
    return best_.size() == request_.vertices ? best_.back().value : -kInfinity;
  }
  [[nodiscard]] const std::vector<Candidate>& best() const noexcept { return best_; }

  /// The records that reach above the cut-off, a set closed under dependency.
  [[nodiscard]] std::vector<PendingSplit> take_splits() {
    std::vector<PendingSplit> wanted;
    for (std::size_t i = 0; i < splits_.size(); ++i) {
      if (bounds_[i] > cut_off()) {
        wanted.push_back(splits_[i]);
      }
    }
    context_.cost.records_retrieved += wanted.size();
    return wanted;
  }

 private:
  void offer(GridPoint p, HeightBits height) {
    const double code = store_.facts().heights.code(height);
    const Candidate c{request_.lowest ? -code : code, key_of(p)};
    if (!(c.value > cut_off()) || (window_ != nullptr && !window_->meets(box_of(p))) ||
        rejected.contains(c.key)) {
      return;
    }
    const auto place =
        std::upper_bound(best_.begin(), best_.end(), c,
                         [](const Candidate& a, const Candidate& b) { return a.value > b.value; });
    best_.insert(place, c);
    if (best_.size() > request_.vertices) {
      best_.pop_back();
    }
  }

  const StoreFile& store_;
  const HighestRequest& request_;
  const AttributePredicate& predicate_;
  const GridRegion* window_;
  QueryContext& context_;
  std::vector<Candidate> best_;  ///< Falling.
  std::vector<PendingSplit> splits_;
  std::vector<double> bounds_;  ///< Beside splits_.
  std::vector<VertexSplit> records_;
};

/// A rectangle on the grid, in real numbers.
struct Rectangle {
  double min_x, min_y, max_x, max_y;
  [[nodiscard]] bool holds(double x, double y) const noexcept {
    return min_x <= x && x <= max_x && min_y <= y && y <= max_y;
  }
};

/// The part of a triangle in a rectangle: at most seven corners.
using Corner = std::array<double, 3>;
std::vector<Corner> clipped(std::vector<Corner> polygon, const Rectangle& r) {
  const std::array<std::array<double, 4>, 4> sides = {
      {{0, r.min_x, 1, 0}, {0, r.max_x, -1, 0}, {1, r.min_y, 1, 0}, {1, r.max_y, -1, 0}}};
  for (const auto& side : sides) {
    const auto axis = static_cast<std::size_t>(side[0]);
    const auto inside = [&](const Corner& c) { return (c[axis] - side[1]) * side[2] >= 0; };
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Corner& a = polygon[i];
      const Corner& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      if (inside(a)) {
        kept.push_back(a);
      }
      if (inside(a) != inside(b)) {
        const double t = (side[1] - a[axis]) / (b[axis] - a[axis]);
        Corner cut{};
        for (std::size_t k = 0; k < 3; ++k) {
          cut[k] = a[k] + t * (b[k] - a[k]);
        }
        cut[axis] = side[1];
        kept.push_back(cut);
      }
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// A corner of the window in spots; what lies beyond the domain's box does so by two grid units.
Spot spot_of_clamped(double x, double y, const GridBox& b) {
  const auto spot = [](double v, std::int32_t low, std::int32_t high) {
    return std::llround(std::ldexp(std::clamp(v, low - 2.0, high + 2.0), kSpotBits));
  };
  return {spot(x, b.min_x, b.max_x), spot(y, b.min_y, b.max_y)};
}

class Search {
 public:
  Search(const ProgressiveTin& terrain, const HighestRequest& request)
      : terrain_(terrain),
        store_(terrain.store()),
        facts_(store_.facts()),
        request_(request),
        context_(request.stop, request.memory_limit_bytes, store_.path()) {
    if (request.vertices == 0) {
      throw Error(ErrorCode::invalid_argument, "no vertex is asked for: expected at least one");
    }
    if (request.window) {
      region_.emplace(*request.window, facts_.map);
      predicate_ = meets_region(*request.window, facts_.map);
    } else {
      predicate_ = everything();
    }
  }

  HighestResult run() {
    HighestResult result;
    result.certified_error = facts_.base_error;
    result.certified_deviation = facts_.base_deviation;
    result.exact = facts_.base_error == 0;
    if (region_ && !region_->meets(facts_.bounds)) {
      result.state = HighestResult::State::kOutside;
      return result;
    }
    Gatherer gatherer(terrain_, request_, *predicate_, region_ ? &*region_ : nullptr, context_);
    do {
      gatherer.start();
      gather(gatherer);
    } while (has_void_vertices() && reject_lone(gatherer));
    for (const Candidate& c : gatherer.best()) {
      const GridPoint p = point_of(c.key);
      result.vertices.push_back(at(p.x, p.y, c.value));
    }
    Refinement refinement(terrain_.t0());
    refinement.apply(gatherer.take_splits(), context_);
    find_point(refinement.tin(), gatherer.best(), result);
    store_.pages().check_unchanged();
    result.cost = context_.cost;
    return result;
  }

 private:
  [[nodiscard]] HeightAt at(double x, double y, double value) const {
    return {facts_.map.to_map(x, y),
            facts_.heights.height_of_code(request_.lowest ? -value : value)};
  }

  void gather(Gatherer& gatherer) {
    if (const auto* tree = dynamic_cast<const PackedRTree*>(&terrain_.index())) {
      tree->search_best_first(gatherer, context_.cost.io);
      return;
    }
    std::vector<PageId> pages;  // another index: the same order, after a whole search
    terrain_.index().search(*predicate_, pages, context_.cost.io);
    std::vector<std::pair<double, PageId>> order;
    for (const PageId page : pages) {
      order.emplace_back(gatherer.bound(store_.page_info(page).attributes), page);
    }
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    double cut_off = -kInfinity;
    for (const auto& [bound, page] : order) {
      if (bound < cut_off || bound == -kInfinity) {
        break;
      }
      cut_off = gatherer.visit(page);
    }
  }

  [[nodiscard]] bool has_void_vertices() const {
    const auto bins = store_.error_bins();
    const auto& t0 = store_.t0().vertices;
    return std::any_of(bins.begin(), bins.end(),
                       [](const ErrorBin& b) { return b.void_vertices > 0; }) ||
           std::any_of(t0.begin(), t0.end(),
                       [](const CoarsestTin::V& v) { return v.has_height == 0; });
  }

  /// A sample whose neighbours are all void has a height, but no surface. Returns true when one was
  /// among the best.
  bool reject_lone(Gatherer& gatherer) {
    std::vector<PredicatePtr> around;
    for (const Candidate& c : gatherer.best()) {
      const GridPoint p = point_of(c.key);
      around.push_back(meets_region(facts_.map.to_map(p.x, p.y), facts_.map));
    }
    const RecordSource source{store_, terrain_.index()};
    Refinement refinement(terrain_.t0());
    refinement.apply(retrieve(source, *any_of(std::move(around)), 0, context_), context_);
    bool any = false;
    for (const Candidate& c : gatherer.best()) {
      if (!touches_surface(refinement.tin(), refinement.find(c.key))) {
        gatherer.rejected.insert(c.key);
        any = true;
      }
    }
    return any;
  }

  [[nodiscard]] Rectangle rectangle() const {
    if (!request_.window) {
      const GridBox& b = facts_.bounds;
      return {static_cast<double>(b.min_x), static_cast<double>(b.min_y),
              static_cast<double>(b.max_x), static_cast<double>(b.max_y)};
    }
    const MapPoint low = facts_.map.to_grid({request_.window->min_x, request_.window->min_y});
    const MapPoint high = facts_.map.to_grid({request_.window->max_x, request_.window->max_y});
    return {low.x, low.y, high.x, high.y};
  }

  /// The highest vertex, or a point on the window's border above it.
  void find_point(const Tin& tin, const std::vector<Candidate>& best, HighestResult& result) {
    double most = best.empty() ? -kInfinity : best.front().value;
    if (!best.empty()) {
      result.point = result.vertices.front();
      result.at_vertex = true;
    }
    const Rectangle window = rectangle();
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (t % kStopInterval == 0) {
        context_.check_stop();
      }
      if (!tin.is_alive(t) || tin.classes[t] != TriangleClass::kSurface) {
        continue;
      }
      std::vector<Corner> corners;
      double highest = -kInfinity;
      for (const VertexId v : tin.triangles[t].v) {
        const double code = facts_.heights.code(tin.vertices[v].height);
        const GridPoint p = tin.position(v);
        corners.push_back(
            {static_cast<double>(p.x), static_cast<double>(p.y), request_.lowest ? -code : code});
        highest = std::max(highest, corners.back()[2]);
      }
      if (!(highest > most)) {
        continue;
      }
      for (const Corner& c : clipped(std::move(corners), window)) {
        if (c[2] > most) {
          most = c[2];
          result.point = at(c[0], c[1], c[2]);
          result.at_vertex = false;
        }
      }
    }
    if (most == -kInfinity) {
      result.state = meets_domain() ? HighestResult::State::kVoid : HighestResult::State::kOutside;
      return;
    }
    result.height_min = result.point.height - facts_.base_deviation;
    result.height_max = result.point.height + facts_.base_deviation;
  }

  /// Whether the window and some triangle of T0, which cover the domain, share a point. Exact, of
  /// corners taken to spots.
  [[nodiscard]] bool meets_domain() const {
    const GridBox& b = facts_.bounds;
    const Rectangle r = rectangle();
    const Spot low = spot_of_clamped(r.min_x, r.min_y, b);
    const Spot high = spot_of_clamped(r.max_x, r.max_y, b);
    const std::array<Spot, 4> corners{low, Spot{high.x, low.y}, high, Spot{low.x, high.y}};
    const Tin& t0 = terrain_.t0();
    return std::any_of(t0.triangles.begin(), t0.triangles.end(), [&](const Triangle& t) {
      GridBox box = box_of(t0.position(t.v[0]));
      box = united(united(box, box_of(t0.position(t.v[1]))), box_of(t0.position(t.v[2])));
      const Spot box_low = spot_of(GridPoint{box.min_x, box.min_y});
      const Spot box_high = spot_of(GridPoint{box.max_x, box.max_y});
      if (high.x < box_low.x || high.y < box_low.y || box_high.x < low.x || box_high.y < low.y) {
        return false;
      }
      for (int i = 0; i < 3; ++i) {  // no side has all of the window beyond it
        const GridPoint from = t0.position(t.v[i]);
        const GridPoint to = t0.position(t.v[next_corner(i)]);
        if (std::all_of(corners.begin(), corners.end(),
                        [&](Spot s) { return side(from, to, s) < 0; })) {
          return false;
        }
      }
      return true;
    });
  }

  const ProgressiveTin& terrain_;
  const StoreFile& store_;
  const StoreFacts& facts_;
  const HighestRequest& request_;
  QueryContext context_;
  std::optional<GridRegion> region_;
  PredicatePtr predicate_;
};

}  // namespace

HighestResult highest(const ProgressiveTin& terrain, const HighestRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  HighestResult result = Search(terrain, request).run();
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ptin
