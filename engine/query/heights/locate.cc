// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/locate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/infinity.h"
#include "engine/query/heights/located_point.h"
#include "engine/query/living/triangle_at.h"
#include "engine/query/paper/selective_refinement.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/walk/spot_set.h"
#include "engine/query/walk/walk.h"

namespace ptin {

namespace {

/// Points looked for together: so many that few pages are read for two groups, and half as much
/// memory as there is.
constexpr std::size_t kMostGroupPoints = 131072;
constexpr std::size_t kLeastGroupPoints = 8192;
constexpr std::uint64_t kGroupRecords = std::uint64_t{1} << 18;

/// A point of the request on its way along the curve.
struct Ordered {
  std::uint64_t along;  ///< Position along the Hilbert curve.
  std::uint64_t index;  ///< In the request.
  Spot spot;
};

class Locating {
 public:
  /// @param detail  The level of the request where the caller has found it already; else null.
  Locating(const OpenedTerrain& terrain, const LocateRequest& request, const Detail* detail)
      : terrain_(terrain),
        facts_(terrain.store().facts()),
        request_(request),
        context_(request.limits, terrain.store().path()),
        detail_(detail != nullptr ? *detail
                                  : Detail(request.detail, terrain.record_source(), context_)) {}

  LocateResult run(std::span<const MapPoint> points) {
    result_.points.resize(points.size());
    const std::vector<Ordered> ordered = order(points);
    const std::size_t most = group_points();
    for (std::size_t begin = 0; begin < ordered.size(); begin += most) {
      const std::size_t count = std::min(most, ordered.size() - begin);
      locate_group(std::span(ordered).subspan(begin, count));
    }
    terrain_.store().pages().check_unchanged();
    result_.certified_error = detail_.certificate().error;
    result_.certified_deviation = detail_.certificate().deviation;
    result_.exact = detail_.is_exact(facts_);
    result_.cost = context_.cost;
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::vector<Ordered> order(std::span<const MapPoint> points) const;
  [[nodiscard]] std::size_t group_points() const {
    const std::uint64_t fit =
        context_.left_beside(result_.points.size() * (sizeof(LocatedPoint) + sizeof(Ordered))) / 2 /
        (sizeof(Spot) + sizeof(TriangleAt));
    return std::clamp<std::uint64_t>(fit, kLeastGroupPoints, kMostGroupPoints);
  }
  void locate_group(std::span<const Ordered> group);
  [[nodiscard]] bool is_by_stars() const noexcept {
    return request_.by == AnswerBy::kStars && !terrain_.uses_other_index();
  }
  void locate_by_stars(std::span<const Ordered> group);
  void locate_by_splits(std::span<const Ordered> group);
  void locate_exactly(std::span<const Ordered> group, std::span<const PageId> pages,
                      const SpotSet& wanted);
  void locate_bounded(std::span<const Ordered> group, std::span<const PageId> pages,
                      const SpotSet& wanted);
  /// Answers the points of a group on `tin`.  @param bounds_of  Bounds of the full surface below a
  /// triangle.
  template <typename BoundsOf>
  void walk_group(const Tin& tin, std::span<const Ordered> group, const BoundsOf& bounds_of);
  [[nodiscard]] LocatedPoint answer(const TriangleAt& at, Spot spot) const;

  const OpenedTerrain& terrain_;
  const StoreFacts& facts_;
  const LocateRequest& request_;
  QueryContext context_;
  Detail detail_;
  // Of the group at hand; the next group uses the same memory.
  std::vector<Spot> spots_;
  std::vector<TriangleAt> found_;
  std::vector<PendingSplit> splits_;
  std::optional<Refinement> refinement_;
  LocateResult result_;
};

std::vector<Ordered> Locating::order(std::span<const MapPoint> points) const {
  const SpotMap map(facts_.map, facts_.bounds);
  std::vector<Ordered> ordered;
  ordered.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kStopInterval == 0) {
      context_.check_stop();
    }
    if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y)) {
      throw Error(ErrorCode::invalid_argument,
                  "point " + std::to_string(i) +
                      " has a coordinate that is not a finite number: give map units of the "
                      "terrain's CRS",
                  terrain_.store().path());
    }
    const std::optional<Spot> spot = map.spot(points[i]);
    if (spot && contains(facts_.bounds, *spot)) {  // other points keep the state kOutside
      const auto x = static_cast<std::uint32_t>(spot->x >> kSpotBits);
      const auto y = static_cast<std::uint32_t>(spot->y >> kSpotBits);
      ordered.push_back({points.size() > 1 ? hilbert_position(x, y) : 0, i, *spot});
    }
  }
  std::sort(ordered.begin(), ordered.end(), [](const Ordered& a, const Ordered& b) {
    return a.along != b.along ? a.along < b.along : a.index < b.index;
  });
  return ordered;
}

void Locating::locate_group(std::span<const Ordered> group) {
  if (is_by_stars()) {
    locate_by_stars(group);
  } else {
    locate_by_splits(group);
  }
}

void Locating::locate_by_stars(std::span<const Ordered> group) {
  const std::uint64_t held = result_.points.size() * (sizeof(LocatedPoint) + sizeof(Ordered)) +
                             group.size() * (sizeof(Spot) + sizeof(TriangleAt));
  context_.admit(held);
  spots_.clear();
  for (const Ordered& o : group) {
    spots_.push_back(o.spot);
  }
  found_.resize(group.size());
  find_triangles(terrain_, detail_, spots_, found_, held, context_);
  for (std::size_t i = 0; i < group.size(); ++i) {
    result_.points[group[i].index] = answer(found_[i], spots_[i]);
  }
}

/// A group whose records might not fit, or are very many, is halved.
void Locating::locate_by_splits(std::span<const Ordered> group) {
  std::vector<Spot> spots;
  spots.reserve(group.size());
  std::transform(group.begin(), group.end(), std::back_inserter(spots),
                 [](const Ordered& o) { return o.spot; });
  const SpotSet wanted(spots, detail_.tolerance());
  std::vector<PageId> pages;
  terrain_.index().search(wanted, pages, context_.cost.io);
  context_.check_stop();
  const std::uint64_t records = most_records(terrain_.store(), pages);
  const std::uint64_t held = result_.points.size() * (sizeof(LocatedPoint) + sizeof(Ordered));
  const std::uint64_t bytes = held + bytes_of(terrain_.t0()) + refinement_bytes(records);
  if (group.size() > 1 && (records > kGroupRecords || bytes > request_.limits.memory_bytes)) {
    locate_group(group.first(group.size() / 2));
    locate_group(group.subspan(group.size() / 2));
    return;
  }
  context_.admit(bytes);
  if (detail_.is_asked()) {
    locate_bounded(group, pages, wanted);
  } else {
    locate_exactly(group, pages, wanted);
  }
}

void Locating::locate_exactly(std::span<const Ordered> group, std::span<const PageId> pages,
                              const SpotSet& wanted) {
  splits_.clear();
  read_pages(terrain_.store(), pages, wanted, context_, splits_);
  if (refinement_) {
    refinement_->restart(terrain_.t0());
  } else {
    refinement_.emplace(terrain_.t0());
  }
  refinement_->apply(splits_, context_);
  walk_group(refinement_->tin(), group, [](TriangleId) {
    return SurfaceBounds{0.0, {-kInfinity, kInfinity}};
  });
}

void Locating::locate_bounded(std::span<const Ordered> group, std::span<const PageId> pages,
                              const SpotSet& wanted) {
  BoundedMesh mesh(terrain_, detail_);
  mesh.refine(pages, wanted, context_);
  walk_group(mesh.tin(), group, [&](TriangleId t) {
    SurfaceBounds bounds = mesh.bounds(t);
    bounds.deviation = std::min(bounds.deviation, detail_.certificate().deviation);
    return bounds;
  });
}

template <typename BoundsOf>
void Locating::walk_group(const Tin& tin, std::span<const Ordered> group,
                          const BoundsOf& bounds_of) {
  TriangleId near = 0;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (i % kStopInterval == 0) {
      context_.check_stop();
    }
    const Place place = find_spot(tin, group[i].spot, near);
    near = place.triangle;
    LocatedPoint& point = result_.points[group[i].index];
    point = located_at(tin, facts_.heights, group[i].spot, place);
    if (point.state == PointState::kSurface) {
      set_interval(bounds_of(answering_triangle(tin, place)), facts_, point);
    }
  }
}

LocatedPoint Locating::answer(const TriangleAt& at, Spot spot) const {
  LocatedPoint point;
  if (!at.is_found) {
    return point;
  }
  const LivingTriangle& t = at.triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    point.triangle[i].position = t.corner[i].position;
    if (t.corner[i].has_height) {
      point.triangle[i].height = facts_.heights.height(t.corner[i].height);
    }
  }
  point.state = t.is_void ? PointState::kVoid : PointState::kSurface;
  if (!t.is_void) {
    point.height = facts_.heights.height_of_code(codes_in(t, facts_.heights, spot).mean());
    // Where the full TIN was asked for, a height is no interval.
    SurfaceBounds bounds{0.0, {-kInfinity, kInfinity}};
    if (detail_.is_asked()) {
      bounds = {std::min(t.deviation, detail_.certificate().deviation), t.heights};
    }
    set_interval(bounds, facts_, point);
  }
  begin_with_least(point.triangle);
  return point;
}

}  // namespace

LocateResult locate(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                    const LocateRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  LocateResult result = Locating(terrain, request, nullptr).run(points);
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

LocateResult locate_at(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                       const LocateRequest& request, const Detail& detail) {
  return Locating(terrain, request, &detail).run(points);
}

}  // namespace ptin
