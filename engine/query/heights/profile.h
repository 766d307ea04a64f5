// SPDX-License-Identifier: GPL-3.0-or-later
//
// The height along a line, with a break at every edge of the TIN that it crosses.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/heights/locate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/query_limits.h"

namespace ptin {

struct ProfileRequest {
  /// Distance over ground between two map positions; none: in the plane of the map. For the
  /// ellipsoid below geographic coordinates.
  std::function<double(MapPoint, MapPoint)> ground_distance;
  DetailRequest detail;  ///< Of which TIN the profile is.
  /// Lines whose records do not fit the memory are walked one by one, or in pieces.
  QueryLimits limits;
};

/// A point where the profile bends: a vertex of the line, or where it crosses an edge or a vertex
/// of the TIN. Between two points the surface is straight.
struct ProfilePoint {
  MapPoint position;      ///< Map units.
  double distance = 0.0;  ///< Along its line, over ground; in between in proportion.
  /// Height's unit; NaN where no surface touches the line.
  double height = std::numeric_limits<double>::quiet_NaN();
  /// What the stretch that begins here runs over; of a last point, what the one before does.
  PointState state = PointState::kOutside;
  std::uint32_t part = 0;  ///< Which segment of its line it is on.
  std::uint32_t line = 0;  ///< Which line.
};

struct ProfileResult {
  std::vector<ProfilePoint> points;  ///< Line by line.
  std::uint64_t skipped_lines = 0;   ///< Of several: those without length, which have no points.
  double certified_error = 0.0;      ///< At samples.
  double certified_deviation = 0.0;  ///< Of every height.
  bool exact = false;
  QueryCost cost;
};

/// Walks along polylines. Segments of no length are left out, and of several lines those without
/// any length.
/// @throws Error invalid_argument    no line has a length; a coordinate that is not finite, or more
///                                   than 2^31 grid units away (names the line); as Detail
///               resource_exhausted  one segment, or the points, exceed the memory limit
///               corruption, io_error, cancelled
/// Cost: the records whose region of influence meets a line, each test of one the logarithm of the
/// segments, and the triangles on the way. Lines are taken along the Hilbert curve, in groups that
/// share one refinement each, so what several need is read and applied once a group. With
/// `vertices` that of Detail is added.
[[nodiscard]] ProfileResult profile(const OpenedTerrain& terrain, std::span<const MapPoint> line,
                                    const ProfileRequest& request = {});
[[nodiscard]] ProfileResult profile(const OpenedTerrain& terrain,
                                    std::span<const std::vector<MapPoint>> lines,
                                    const ProfileRequest& request = {});

}  // namespace ptin
