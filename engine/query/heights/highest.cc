// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/highest.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/heights/highest_gather.h"
#include "engine/query/heights/locate.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/predicate.h"
#include "engine/query/walk/spot.h"

namespace ptin {

namespace {

constexpr std::size_t kFirstSpare = 16;  // vertices located beyond those asked for

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

/// A corner of the window as a spot. A corner beyond the domain's box is moved to two grid units
/// beyond it.
Spot spot_of_clamped(double x, double y, const GridBox& b) {
  const auto spot = [](double v, std::int32_t low, std::int32_t high) {
    return std::llround(std::ldexp(std::clamp(v, low - 2.0, high + 2.0), kSpotBits));
  };
  return {spot(x, b.min_x, b.max_x), spot(y, b.min_y, b.max_y)};
}

class Search {
 public:
  Search(const OpenedTerrain& terrain, const HighestRequest& request)
      : terrain_(terrain),
        store_(terrain.store()),
        facts_(store_.facts()),
        request_(request),
        context_(request.limits, store_.path()) {
    if (request.listed == 0) {
      throw Error(ErrorCode::invalid_argument, "no vertex is asked for: expected at least one");
    }
    if (request.window) {
      region_.emplace(*request.window, facts_.map);
    }
  }

  HighestResult run() {
    const Detail detail(request_.detail, terrain_.record_source(), context_);
    HighestResult result;
    result.certified_error = detail.certificate().error;
    result.certified_deviation = detail.certificate().deviation;
    result.exact = detail.is_exact(facts_);
    if (region_ && !region_->meets(facts_.bounds)) {
      store_.pages().check_unchanged();  // the bounds of a file that was replaced say nothing
      result.state = PointState::kOutside;
      result.cost = context_.cost;
      return result;
    }
    const PredicatePtr predicate = predicate_of(detail);
    HighGatherer gatherer(store_, *predicate, detail, region_ ? &*region_ : nullptr,
                          request_.lowest, context_);
    // At a level of detail a vertex may stand in void triangles alone, and touch the surface in a
    // finer TIN.
    const bool any_rejected = detail.is_asked() || !facts_.free_of_voids;
    const std::vector<HighCandidate> best =
        any_rejected ? find_on_surface(gatherer) : find(gatherer, request_.listed);
    for (const HighCandidate& c : best) {
      const GridPoint p = point_of(c.key);
      result.vertices.push_back(at(p.x, p.y, c.value));
    }
    const std::vector<PendingSplit> splits = gatherer.take_splits();
    context_.admit(bytes_of(terrain_.t0()) + refinement_bytes(splits.size()));
    Refinement refinement(terrain_.t0());
    refinement.apply(splits, context_);
    find_point(refinement.tin(), best, result);
    store_.pages().check_unchanged();
    result.cost = context_.cost;
    return result;
  }

 private:
  [[nodiscard]] HeightAt at(double x, double y, double value) const {
    return {facts_.map.to_map(x, y),
            facts_.heights.height_of_code(request_.lowest ? -value : value)};
  }

  [[nodiscard]] PredicatePtr predicate_of(const Detail& detail) const {
    std::vector<PredicatePtr> parts;
    if (request_.window) {
      parts.push_back(meets_region(*request_.window, facts_.map));
    }
    if (detail.is_asked()) {
      parts.push_back(std::make_shared<AboveError>(detail.tolerance()));
    }
    return all_of(std::move(parts));
  }

  std::vector<HighCandidate> find(HighGatherer& gatherer, std::size_t wanted) {
    gatherer.start(wanted);
    if (const auto* tree = dynamic_cast<const PackedRTree*>(&terrain_.index())) {
      tree->search_best_first(gatherer, context_.cost.io);
    } else {
      search_in_order(gatherer);
    }
    return gatherer.take_best();
  }

  /// For another index: visits the pages in the same order, after a search of all of them.
  void search_in_order(HighGatherer& gatherer) {
    std::vector<PageId> pages;
    terrain_.index().search(*predicate_of_pages(), pages, context_.cost.io);
    std::vector<std::pair<Merit, PageId>> order;
    for (const PageId page : pages) {
      order.emplace_back(gatherer.bound(store_.page_info(page).attributes), page);
    }
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return b.first.is_below(a.first); });
    Merit cut_off = kNoMerit;
    for (const auto& [bound, page] : order) {
      if (bound.is_below(cut_off) || bound.value == -kInfinity) {
        break;
      }
      cut_off = gatherer.visit(page);
    }
  }

  [[nodiscard]] PredicatePtr predicate_of_pages() const {
    return request_.window ? meets_region(*request_.window, facts_.map) : everything();
  }

  /// A vertex whose triangles are all void has a height, but is not of the surface. So it searches
  /// again, each time for more spare vertices, until enough vertices of the surface are found and
  /// the very best vertex is one of them: the records were gathered that reach above that vertex.
  std::vector<HighCandidate> find_on_surface(HighGatherer& gatherer) {
    std::size_t spare = 0;
    while (true) {
      std::vector<HighCandidate> best = find(gatherer, request_.listed + spare);
      const bool are_all = best.size() < request_.listed + spare;
      const VertexKey first = best.empty() ? kNoVertexKey : best.front().key;
      look_up(best, gatherer);
      std::erase_if(best, [&](const HighCandidate& c) { return gatherer.is_rejected(c.key); });
      if ((are_all || best.size() >= request_.listed) && !gatherer.is_rejected(first)) {
        best.resize(std::min<std::size_t>(best.size(), request_.listed));
        return best;
      }
      spare = std::max<std::size_t>(2 * spare, kFirstSpare);
    }
  }

  /// Locates the candidates that the gatherer was not told of before, and tells it which of them
  /// are of the surface.
  void look_up(const std::vector<HighCandidate>& best, HighGatherer& gatherer) {
    std::vector<VertexKey> keys;
    for (const HighCandidate& c : best) {
      if (!gatherer.is_told(c.key)) {
        keys.push_back(c.key);
      }
    }
    std::vector<MapPoint> points;
    points.reserve(keys.size());
    for (const VertexKey key : keys) {
      const GridPoint p = point_of(key);
      points.push_back(facts_.map.to_map(p.x, p.y));
    }
    gatherer.reserve_told(keys.size());
    LocateRequest request;
    request.detail = request_.detail;
    request.limits.memory_bytes = context_.left_beside(
        gatherer.held_bytes() + best.capacity() * sizeof(HighCandidate) +
        keys.capacity() * sizeof(VertexKey) + points.capacity() * sizeof(MapPoint));
    request.limits.stop = request_.limits.stop;
    const LocateResult located = locate_at(terrain_, points, request, gatherer.detail());
    context_.cost.add_counts(located.cost);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      gatherer.tell(keys[i], located.points[i].state == PointState::kSurface);
    }
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

  /// Sets the point of `result`: the highest vertex, or a higher point on the border of the window.
  void find_point(const Tin& tin, const std::vector<HighCandidate>& best, HighestResult& result) {
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
      result.state = meets_domain() ? PointState::kVoid : PointState::kOutside;
      return;
    }
    // The deviation, widened by the rounding of the height and of the sum.
    const double deviation = result.certified_deviation;
    const double rounding =
        16 * std::numeric_limits<double>::epsilon() *
        (std::abs(result.point.height) + std::abs(facts_.heights.offset) + deviation);
    const double reach = deviation == 0 ? 0.0 : deviation + rounding;
    result.height_min = result.point.height - reach;
    result.height_max = result.point.height + reach;
  }

  /// Whether the window and the domain, which the triangles of T0 cover, share a point. Exact for
  /// the corners of the window as spots.
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
      for (int i = 0; i < 3; ++i) {  // apart when one side has the whole window beyond it
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

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StoreFacts& facts_;
  const HighestRequest& request_;
  QueryContext context_;
  std::optional<GridRegion> region_;
};

}  // namespace

HighestResult highest(const OpenedTerrain& terrain, const HighestRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  HighestResult result = Search(terrain, request).run();
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ptin
