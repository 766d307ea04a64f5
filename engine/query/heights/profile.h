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
  /// Distance over ground between two map positions, for example along the ellipsoid of a
  /// geographic CRS; none: the distance in the plane, in map units.
  std::function<double(MapPoint, MapPoint)> ground_distance;
  /// Above 0: a point stands at every multiple of this distance along each line too, from its
  /// beginning, and its ends count as stations. In the unit of `ground_distance`.
  double station_step = 0.0;
  DetailRequest detail;  ///< The TIN along which the profile runs.
  /// Lines that do not fit the memory together are walked one by one, or in pieces.
  QueryLimits limits;
};

/// A point where the profile bends: a vertex of the line, or where it crosses an edge or a vertex
/// of the TIN; or a station. Between two points the surface is straight.
struct ProfilePoint {
  MapPoint position;      ///< Map units.
  double distance = 0.0;  ///< From the beginning of its line, over ground.
  /// Height's unit; NaN where no surface touches the line.
  double height = std::numeric_limits<double>::quiet_NaN();
  /// What the stretch that begins here runs over. For the last point of a line: what the stretch
  /// before it runs over.
  PointState state = PointState::kOutside;
  bool is_station =
      false;  ///< At a multiple of ProfileRequest::station_step, or an end of its line.
  std::uint32_t part = 0;  ///< Segment of its line, from 0.
  std::uint32_t line = 0;  ///< Index of its line in the request.
};

struct ProfileResult {
  std::vector<ProfilePoint> points;  ///< Line by line.
  std::uint64_t skipped_lines = 0;   ///< Lines without length among several; they have no points.
  double certified_error = 0.0;      ///< Bound of the error at samples.
  double certified_deviation = 0.0;  ///< Bound of the deviation of every height.
  bool exact = false;
  QueryCost cost;
};

/// The heights along polylines. Segments of no length are left out, and among several lines those
/// without any length.
/// @throws Error invalid_argument    no line has a length; a coordinate that is not finite, or more
///                                   than 2^31 grid units away (names the line); a step between
///                                   stations that is negative or not finite; as Detail
///               resource_exhausted  what one segment crosses, or the points of the result,
///                                   exceed the memory limit; more stations than fit it, before
///                                   anything is read
///               corruption, io_error, cancelled
/// Cost: the pages whose stars meet a line, where each test takes the logarithm of the number of
/// segments; and the triangles on the way. Lines are taken along the Hilbert curve, in groups that
/// share their pages. With `vertices` the cost of Detail is added.
[[nodiscard]] ProfileResult profile(const OpenedTerrain& terrain, std::span<const MapPoint> line,
                                    const ProfileRequest& request = {});
[[nodiscard]] ProfileResult profile(const OpenedTerrain& terrain,
                                    std::span<const std::vector<MapPoint>> lines,
                                    const ProfileRequest& request = {});

}  // namespace ptin
