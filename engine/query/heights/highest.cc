// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/highest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/heights/region_border.h"
#include "engine/query/living/floor_cells.h"
#include "engine/query/living/level_stars.h"
#include "engine/query/select/detail.h"
#include "storage/packed_rtree.h"

namespace ptin {

namespace {

/// A vertex that may be among the highest.
struct HighCandidate {
  double value;  ///< Its height's code, negated when the lowest are wanted.
  VertexKey key;
  /// The order of the best vertices, which no file's layout changes.
  bool operator<(const HighCandidate& other) const noexcept {
    return value != other.value ? value > other.value : key < other.key;
  }
};

/// What a candidate takes in a set.
constexpr std::uint64_t kBytesACandidate = 64;

/// Takes the triangles that live at the level, those of the highest stars first. "Above" means
/// below when the lowest are wanted.
class HighestSearch final : private BestStarVisitor, private BestCellVisitor {
 public:
  HighestSearch(const OpenedTerrain& terrain, const HighestRequest& request)
      : terrain_(terrain),
        store_(terrain.store()),
        facts_(store_.facts()),
        request_(request),
        context_(request.limits, store_.path()),
        detail_(checked(request).detail, terrain.record_source(), context_),
        stars_(store_, detail_) {
    filter_.box = facts_.bounds;
    if (request.region) {
      region_.emplace(*request.region, facts_.map);
      filter_.box = region_->bounds();
      if (!std::holds_alternative<Window>(*request.region) &&
          !std::holds_alternative<Polygon>(*request.region)) {
        refuse(
            "the highest point is that of a window or a polygon; a point or a segment has no "
            "inside");
      }
      border_.emplace(*request.region, facts_.map, facts_.bounds);
    }
    set_level(detail_, filter_);
  }

  HighestResult run() {
    HighestResult result;
    result.certified_error = detail_.certificate().error;
    result.certified_deviation = detail_.certificate().deviation;
    result.exact = detail_.is_exact(facts_);
    if (region_ && !region_->meets(facts_.bounds)) {
      result.state = PointState::kOutside;
    } else {
      search();
      for (const HighCandidate& c : best_) {
        const GridPoint p = point_of(c.key);
        result.vertices.push_back(at(p.x, p.y, c.value));
      }
      set_point(result);
    }
    store_.pages().check_unchanged();  // the bounds of a file that was replaced say nothing
    result.cost = context_.cost;
    return result;
  }

 private:
  static const HighestRequest& checked(const HighestRequest& request) {
    if (request.listed == 0) {
      refuse("no vertex is asked for: expected at least one");
    }
    return request;
  }

  [[nodiscard]] HeightAt at(double x, double y, double value) const {
    return {facts_.map.to_map(x, y),
            facts_.heights.height_of_code(request_.lowest ? -value : value)};
  }

  void search() {
    if (const Floor* const floor = floor_for(terrain_, detail_)) {
      Floor::Recent recent;
      visit_floor_best_first(*floor, facts_.heights, filter_.box, *this, cut_off(), recent,
                             context_.cost);
      return;
    }
    const auto look = [&](const LivingTriangle& t) { look_at(t); };
    stars_.visit_t0([&](const GridBox& box) { return meets(box, filter_.box); }, is_surface, look);
    store_.star_index().search_stars_best_first(filter_, *this, cut_off(), context_.cost.io);
    // What was set aside raised no cut-off, so nothing was left out for its sake.
    stars_.settle(look);
  }

  /// The highest vertex of these stars, at the least key in their box.
  [[nodiscard]] Merit bound(const StarAttributes& a) const override {
    return bound_of_cells(a.box, a.heights);
  }
  [[nodiscard]] Merit bound_of_cells(const GridBox& box, const Interval& codes) const override {
    if (is_empty(codes) || (region_ && !region_->meets(box))) {
      return kNoMerit;
    }
    return {request_.lowest ? -codes.lo : codes.hi, key_of({box.min_x, box.min_y})};
  }
  bool begin_cells(const GridBox& /*box*/, Merit /*left*/) override {
    context_.check_stop();
    return true;
  }
  void take_cell(const LivingTriangle& t) override {
    if (!t.is_void) {
      look_at(t);
    }
  }
  Merit end_cells() override {
    context_.admit(best_.size() * kBytesACandidate);
    return cut_off();
  }

  void will_visit(std::span<const GridBox> stars) override {
    store_.announce_heights(stars, context_.heights(), context_.cost.io);
  }

  Merit visit(PageId page, const StarAttributes& /*a*/) override {
    context_.check_stop();
    if (best_.size() == request_.listed) {
      const double last = best_.rbegin()->value;
      filter_.heights = request_.lowest ? Interval{-kInfinity, -last} : Interval{last, kInfinity};
    }
    stars_.read(page, filter_, context_);
    stars_.visit_page([&](const GridBox& box) { return meets(box, filter_.box); }, is_surface,
                      [&](const LivingTriangle& t) { look_at(t); });
    context_.admit(best_.size() * kBytesACandidate + stars_.bytes_aside() +
                   stars_.living().stars.size() * sizeof(LivingStar) +
                   stars_.living().corners.size() * sizeof(LivingCorner));
    return cut_off();
  }

  /// Nothing below this is wanted: it is the last of the best vertices. What a page may hold
  /// without a height is below all of it.
  [[nodiscard]] Merit cut_off() const noexcept {
    return best_.size() == request_.listed ? Merit{best_.rbegin()->value, best_.rbegin()->key}
                                           : Merit{-kInfinity, 0};
  }

  [[nodiscard]] static bool is_surface(const LivingTriangle& t) { return !t.is_void; }

  [[nodiscard]] double value_of(const LivingTriangle::Corner& c) const {
    const double code = facts_.heights.code(c.height);
    return request_.lowest ? -code : code;
  }

  /// Takes the vertices of a surface triangle that lie in the region, and its highest point there
  /// if that lies above all vertices.
  void look_at(const LivingTriangle& t) {
    double highest = -kInfinity;
    for (const LivingTriangle::Corner& c : t.corner) {
      highest = std::max(highest, value_of(c));
      offer({value_of(c), key_of(c.position)});
    }
    const double most = best_.empty() ? -kInfinity : best_.begin()->value;
    if (region_ && highest > most && highest >= on_border_[2]) {
      look_at_border(t);
    }
  }

  void offer(const HighCandidate& c) {
    const bool is_full = best_.size() == request_.listed;
    if ((is_full && !(c < *best_.rbegin())) ||
        (region_ && !region_->meets(box_of(point_of(c.key))))) {
      return;
    }
    if (best_.insert(c).second && is_full) {
      best_.erase(std::prev(best_.end()));
    }
  }

  /// Among equally high points the one farthest south counts, then farthest west.
  void look_at_border(const LivingTriangle& t) {
    std::array<ValuedPlace, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint p = t.corner[i].position;
      corners[i] = {static_cast<double>(p.x), static_cast<double>(p.y), value_of(t.corner[i])};
    }
    if (!std::isfinite(corners[0][2] + corners[1][2] + corners[2][2])) return;  // a damaged file
    const auto is_before = [](const ValuedPlace& a, const ValuedPlace& b) {
      return a[1] != b[1] ? a[1] < b[1] : a[0] < b[0];
    };
    std::vector<ValuedPlace> shared;
    border_->visit_shared(corners, shared);
    for (const ValuedPlace& c : shared) {
      if (c[2] > on_border_[2] || (c[2] == on_border_[2] && is_before(c, on_border_))) {
        on_border_ = c;
      }
    }
  }

  [[nodiscard]] bool region_meets_domain() const {
    const Tin& t0 = terrain_.t0();
    return std::any_of(t0.triangles.begin(), t0.triangles.end(), [&](const Triangle& t) {
      return !region_ ||
             region_->meets(t0.position(t.v[0]), t0.position(t.v[1]), t0.position(t.v[2]));
    });
  }

  /// Sets the point of `result`: the highest vertex, or a higher point on the border of the region.
  void set_point(HighestResult& result) const {
    const double most = best_.empty() ? -kInfinity : best_.begin()->value;
    if (std::max(most, on_border_[2]) == -kInfinity) {
      result.state = region_meets_domain() ? PointState::kVoid : PointState::kOutside;
      return;
    }
    result.at_vertex = !(on_border_[2] > most);
    result.point = result.at_vertex ? result.vertices.front()
                                    : at(on_border_[0], on_border_[1], on_border_[2]);
    // The deviation, widened by the rounding of the height and of the sum. Stored heights need no
    // rounding, and the full TIN's answer is the exact one.
    const double deviation = result.certified_deviation;
    const double rounding =
        16 * std::numeric_limits<double>::epsilon() *
        (std::abs(result.point.height) + std::abs(facts_.heights.offset) + deviation);
    const bool is_stored = on_border_[2] < most;
    const double reach = deviation == 0 && (result.exact || is_stored) ? 0.0 : deviation + rounding;
    result.height_min = result.point.height - reach;
    result.height_max = result.point.height + reach;
  }

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StoreFacts& facts_;
  const HighestRequest& request_;
  QueryContext context_;
  Detail detail_;
  LevelStars stars_;
  std::optional<GridRegion> region_;
  std::optional<RegionBorder> border_;
  LivingFilter filter_;
  std::set<HighCandidate> best_;
  ValuedPlace on_border_{0.0, 0.0, -kInfinity};  ///< The highest point found that is no vertex.
};

}  // namespace

HighestResult highest(const OpenedTerrain& terrain, const HighestRequest& request) {
  return timed([&] { return HighestSearch(terrain, request).run(); });
}

}  // namespace ptin
