// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/locate.h"

#include "engine/geometry/infinity.h"
#include "engine/prefetch.h"
#include "engine/query/heights/locate_in_groups.h"
#include "engine/query/heights/located_point.h"
#include "engine/query/living/triangle_at.h"

namespace ptin {

namespace {

/// The answer of the triangle that lives at the level and holds the spot.
LocatedPoint answer_of(const TriangleAt& at, Spot spot, const Detail& detail,
                       const StoreFacts& facts) {
  LocatedPoint point;
  if (!at.is_found) {
    return point;
  }
  const LivingTriangle& t = at.triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    point.triangle[i].position = t.corner[i].position;
    if (t.corner[i].has_height) {
      point.triangle[i].height = facts.heights.height(t.corner[i].height);
    }
  }
  point.state = t.is_void ? PointState::kVoid : PointState::kSurface;
  if (!t.is_void) {
    point.height = facts.heights.height_of_code(codes_in(t, facts.heights, spot).mean());
    set_interval(bounds_at({t.deviation, t.heights}, detail), !detail.is_asked(), facts, point);
  }
  begin_with_least(point.triangle);
  return point;
}

/// The answer of the triangle of the full TIN around a spot.
LocatedPoint answer_within(const FloorTriangle& t, const StoreFacts& facts) {
  LocatedPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    point.triangle[i].position = t.corner[i].position;
    if (t.corner[i].has_height) {
      point.triangle[i].height = facts.heights.height(t.corner[i].height);
    }
  }
  point.state = t.is_void ? PointState::kVoid : PointState::kSurface;
  if (!t.is_void) {
    point.height = facts.heights.height_of_code(t.codes(facts.heights).mean());
    set_interval({0.0, {-kInfinity, kInfinity}}, true, facts, point);
  }
  return point;
}

/// Answers lie in the order of the request, so that most of them are not at hand: so many points before
/// one is written its memory is asked for.
constexpr std::size_t kAnswersAhead = 16;

/// Points of the full TIN of a raster, which come tile by tile.
void locate_on_floor(const Floor& floor, const StoreFacts& facts, const PointGroup& group) {
  Floor::Recent recent;
  FloorAtSpots triangles(floor, facts.heights, recent);
  if (floor.is_far()) {
    std::vector<Spot> spots;
    for (const PointOnCurve& p : group.points) spots.push_back(p.spot);
    triangles.announce(spots, group.context.cost.io);
  }
  for (std::size_t i = 0; i < group.points.size(); ++i) {
    if (i % kStopInterval == 0) {
      group.context.check_stop();
    }
    if (i + kAnswersAhead < group.points.size()) {
      const LocatedPoint* const ahead = &group.answers[group.points[i + kAnswersAhead].index];
      prefetch(ahead);
      prefetch(&ahead->triangle.back());
    }
    const PointOnCurve& p = group.points[i];
    const auto within = triangles.within(p.spot, group.context.cost);
    group.answers[p.index] =
        within ? answer_within(*within, facts)
               : answer_of(triangle_on_sides(triangles, p.spot, group.context.cost), p.spot,
                           group.detail, facts);
  }
}

}  // namespace

LocateResult locate(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                    const LocateRequest& request) {
  std::vector<Spot> spots;  // of the group at hand; the next group uses the same memory
  std::vector<TriangleAt> found;
  return locate_in_groups(terrain, points, request, [&](const PointGroup& group) {
    if (group.floor != nullptr) {
      return locate_on_floor(*group.floor, terrain.store().facts(), group);
    }
    const std::uint64_t held =
        group.bytes_held() + group.points.size() * (sizeof(Spot) + sizeof(TriangleAt));
    group.context.admit(held);
    spots.clear();
    for (const PointOnCurve& p : group.points) {
      spots.push_back(p.spot);
    }
    found.resize(spots.size());
    find_triangles(terrain, group.detail, spots, found, held, group.context);
    for (std::size_t i = 0; i < spots.size(); ++i) {
      group.answers[group.points[i].index] =
          answer_of(found[i], spots[i], group.detail, terrain.store().facts());
    }
  });
}

}  // namespace ptin
