// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/point_location.h"

#include <vector>

#include "engine/query/heights/locate_in_groups.h"
#include "engine/query/heights/located_point.h"
#include "engine/query/paper/selective_refinement.h"
#include "engine/query/shape/tiler.h"
#include "engine/query/walk/spot_set.h"
#include "engine/query/walk/walk.h"

namespace ptin::paper {

namespace {

/// A mesh of more records than these would not stay in the processor's caches.
constexpr std::uint64_t kMostRecords = std::uint64_t{1} << 18;

/// Answers the points of a group on a mesh that is fine at all of them. Points follow the curve, so
/// each walk begins near its end.
void walk(const PointGroup& group, const SelectiveRefinement& mesh, const StoreFacts& facts) {
  TriangleId near = 0;
  for (std::size_t i = 0; i < group.points.size(); ++i) {
    if (i % kStopInterval == 0) {
      group.context.check_stop();
    }
    const PointOnCurve& p = group.points[i];
    const Place place = find_spot(mesh.tin(), p.spot, near);
    near = place.triangle;
    LocatedPoint& point = group.answers[p.index];
    point = located_at(mesh.tin(), facts.heights, p.spot, place);
    if (point.state == PointState::kSurface) {
      const TriangleId t = answering_triangle(mesh.tin(), place);
      set_interval(bounds_at(mesh.bounds(t), group.detail), !group.detail.is_asked(), facts, point);
    }
  }
}

/// Answers the points of a group, unless their records might not fit or are very many.
bool locate_group(const OpenedTerrain& terrain, const PointGroup& group) {
  std::vector<Spot> spots;
  for (const PointOnCurve& p : group.points) {
    spots.push_back(p.spot);
  }
  const SpotSet holds_a_point(spots, group.detail.tolerance());
  SelectiveRefinement mesh(terrain, group.detail);
  const std::vector<PageId> pages = mesh.search(holds_a_point, group.context);
  const std::uint64_t bytes = group.bytes_held() + mesh.bytes_with(pages);
  if (group.points.size() > 1 &&
      (most_records(terrain.store(), pages) > kMostRecords || !group.context.fits(bytes))) {
    return false;
  }
  group.context.admit(bytes);
  mesh.refine(pages, holds_a_point, group.context);
  walk(group, mesh, terrain.store().facts());
  return true;
}

}  // namespace

LocateResult locate(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                    const LocateRequest& request) {
  return locate_in_groups(terrain, points, request, [&](const PointGroup& group) {
    work_in_parts(group.points, [&](std::span<const PointOnCurve> some) {
      return locate_group(terrain, {some, group.answers, group.floor, group.detail, group.context});
    });
  });
}

}  // namespace ptin::paper
