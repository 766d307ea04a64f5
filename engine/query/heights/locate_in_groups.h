// SPDX-License-Identifier: GPL-3.0-or-later
//
// What locating has in common, however the triangles are found: points in order along the Hilbert
// curve, of the grid or of the tiles of heights, in groups.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "engine/query/heights/locate.h"
#include "engine/query/shape/spot.h"

namespace ptin {

/// A point of a request on its way along the curve.
struct PointOnCurve {
  std::uint64_t along;  ///< Position along the Hilbert curve.
  std::uint64_t index;  ///< In the request.
  Spot spot;
};

/// Points that are looked for together: on the grid, and mostly close to each other.
struct PointGroup {
  std::span<const PointOnCurve> points;
  std::span<LocatedPoint> answers;  ///< One for each point of the request, by PointOnCurve::index.
  const Floor* floor;               ///< floor_for() the terrain and the detail.
  const Detail& detail;
  QueryContext& context;

  /// Bytes of the request's points and answers.
  [[nodiscard]] std::uint64_t bytes_held() const noexcept {
    return answers.size() * (sizeof(LocatedPoint) + sizeof(PointOnCurve));
  }
};

/// locate(), where `locate_group` finds the triangles of each group and fills in its answers.
/// @throws Error as locate(), and what `locate_group` throws
[[nodiscard]] LocateResult locate_in_groups(
    const OpenedTerrain& terrain, std::span<const MapPoint> points, const LocateRequest& request,
    const std::function<void(const PointGroup&)>& locate_group);

}  // namespace ptin
