// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/locate_in_groups.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/query/living/triangle_at.h"

namespace ptin {

namespace {

/// Points looked for together: so many that few pages are read for two groups, and half as much
/// memory as there is.
constexpr std::size_t kMostGroupPoints = 131072;
constexpr std::size_t kLeastGroupPoints = 8192;

std::vector<PointOnCurve> along_the_curve(std::span<const MapPoint> points, const StoreFile& store,
                                          const QueryContext& context) {
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
      const auto x = static_cast<std::uint32_t>(spot->x >> kSpotBits);
      const auto y = static_cast<std::uint32_t>(spot->y >> kSpotBits);
      ordered.push_back({points.size() > 1 ? hilbert_position(x, y) : 0, i, *spot});
    }
  }
  std::sort(ordered.begin(), ordered.end(), [](const PointOnCurve& a, const PointOnCurve& b) {
    return a.along != b.along ? a.along < b.along : a.index < b.index;
  });
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
  const std::vector<PointOnCurve> ordered = along_the_curve(points, store, context);
  const PointGroup all{ordered, result.points, detail, context};
  const std::uint64_t fit =
      context.left_beside(all.bytes_held()) / 2 / (sizeof(Spot) + sizeof(TriangleAt));
  const std::size_t most = std::clamp<std::uint64_t>(fit, kLeastGroupPoints, kMostGroupPoints);
  for (std::size_t begin = 0; begin < ordered.size(); begin += most) {
    const std::size_t count = std::min(most, ordered.size() - begin);
    locate_group({all.points.subspan(begin, count), all.answers, detail, context});
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
