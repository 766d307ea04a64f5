// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/locate_in_groups.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/query/living/floor_cells.h"
#include "engine/query/living/triangle_at.h"

namespace ptin {

namespace {

/// Points looked for together: so many that few pages are read for two groups, and half as much
/// memory as there is.
constexpr std::size_t kMostGroupPoints = 131072;
constexpr std::size_t kLeastGroupPoints = 8192;

std::uint64_t place_of(Spot spot, const Floor* floor) {
  if (floor != nullptr) {
    return FloorAtSpots::along(floor->facts().shape, spot);
  }
  return hilbert_position(static_cast<std::uint32_t>(spot.x >> kSpotBits),
                          static_cast<std::uint32_t>(spot.y >> kSpotBits));
}

/// So many bits of places are looked at in a pass of the sort.
constexpr int kBitsOfPass = 11;

/// Sorts points along the curve, and leaves those of one place in the order of the request. Cost: linear
/// in a large batch, for which twice its memory is taken where there is room.
void sort_along(std::vector<PointOnCurve>& points, bool has_room) {
  constexpr std::size_t kPlaces = std::size_t{1} << kBitsOfPass;
  if (points.size() < 2 * kPlaces || !has_room) {
    std::sort(points.begin(), points.end(), [](const PointOnCurve& a, const PointOnCurve& b) {
      return a.along != b.along ? a.along < b.along : a.index < b.index;
    });
    return;
  }
  std::uint64_t differs = 0;
  for (const PointOnCurve& p : points) differs |= p.along ^ points.front().along;
  std::vector<PointOnCurve> sorted(points.size());
  for (int shift = 0; shift < 64 && differs >> shift != 0; shift += kBitsOfPass) {
    const auto place = [&](const PointOnCurve& p) { return (p.along >> shift) % kPlaces; };
    std::array<std::size_t, kPlaces + 1> begin{};
    for (const PointOnCurve& p : points) ++begin[place(p) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const PointOnCurve& p : points) sorted[begin[place(p)]++] = p;
    points.swap(sorted);
  }
}

/// @param floor  Null: a point's place is that of its grid unit; else that of its tile.
std::vector<PointOnCurve> along_the_curve(std::span<const MapPoint> points, const StoreFile& store,
                                          const Floor* floor, const QueryContext& context) {
  const StoreFacts& facts = store.facts();
  const SpotMap map(facts.map, facts.bounds);
  std::vector<PointOnCurve> ordered;
  ordered.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y)) {
      refuse(
          "point " + std::to_string(i) +
              " has a coordinate that is not a finite number: give map units of the terrain's CRS",
          store.path());
    }
    const std::optional<Spot> spot = map.spot(points[i]);
    if (spot && contains(facts.bounds, *spot)) {  // other points keep the state kOutside
      ordered.push_back({points.size() > 1 ? place_of(*spot, floor) : 0, i, *spot});
    }
  }
  constexpr std::size_t kBytes = sizeof(LocatedPoint) + 2 * sizeof(PointOnCurve);
  sort_along(ordered, context.fits(points.size() * kBytes));
  return ordered;
}

}  // namespace

LocateResult locate_in_groups(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                              const LocateRequest& request,
                              const std::function<void(const PointGroup&)>& locate_group) {
  const auto start = std::chrono::steady_clock::now();
  const StoreFile& store = terrain.store();
  QueryContext context(request.limits, store.path());
  const Detail detail(request.detail, terrain.record_source(), context);
  LocateResult result;
  result.points.resize(points.size());
  const Floor* const floor = floor_for(terrain, detail);
  const std::vector<PointOnCurve> ordered = along_the_curve(points, store, floor, context);
  const PointGroup all{ordered, result.points, floor, detail, context};
  const std::uint64_t fit =
      context.left_beside(all.bytes_held()) / 2 / (sizeof(Spot) + sizeof(TriangleAt));
  const std::size_t most = std::clamp<std::uint64_t>(fit, kLeastGroupPoints, kMostGroupPoints);
  for (std::size_t begin = 0; begin < ordered.size(); begin += most) {
    const std::size_t count = std::min(most, ordered.size() - begin);
    locate_group({all.points.subspan(begin, count), all.answers, floor, detail, context});
  }
  store.pages().check_unchanged();
  result.certified_error = detail.certificate().error;
  result.certified_deviation = detail.certificate().deviation;
  result.exact = detail.is_exact(store.facts());
  result.cost = context.cost;
  result.cost.seconds = seconds_since(start);
  return result;
}

}  // namespace ptin
