// SPDX-License-Identifier: GPL-3.0-or-later
//
// Point location: heights at points, one or millions, exact or at an error
// with the interval that the certificate guarantees.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/walk/point_state.h"

namespace ptin {

struct LocateRequest {
  DetailRequest detail;  ///< The TIN of which the heights are.
  QueryLimits limits;
};

/// The answer for one point. The point's grid position is rounded as SpotMap says (2^-22 of a grid
/// unit); everything after that is exact but for the last rounding of `height`.
struct LocatedPoint {
  struct Corner {
    GridPoint position;
    double height = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the vertex has none.
  };
  PointState state = PointState::kOutside;
  /// Height on the TIN that was asked, height's unit; NaN unless `state` is surface. On an edge it
  /// is interpolated between the ends of the edge; on a vertex it is the vertex's.
  double height = std::numeric_limits<double>::quiet_NaN();
  /// [height_min, height_max] holds the height of the source's full TIN at this point, if that TIN
  /// is surface there. NaN where `height` is NaN; both equal to `height` where nothing was left
  /// out.
  double height_min = std::numeric_limits<double>::quiet_NaN();
  double height_max = std::numeric_limits<double>::quiet_NaN();
  /// The closed triangle that holds the point; of several, a surface one before a void one, then
  /// the one whose vertex keys, ascending, come first. Corners counter-clockwise, the one of least
  /// key first. Unset outside.
  std::array<Corner, 3> triangle{};
};

struct LocateResult {
  std::vector<LocatedPoint> points;  ///< In the order of the request.
  double certified_error = 0.0;      ///< Bound of the error at every sample near a point.
  /// Bound of the deviation at every point where the TIN asked and the full one are both surface.
  double certified_deviation = 0.0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.
  QueryCost cost;
};

/// Locates points given in map units. Points are taken along the Hilbert curve in groups, which
/// share what they read.
/// @throws Error invalid_argument    a coordinate is not finite (names the point); tolerance
///                                   negative or NaN; as Detail
///               resource_exhausted  the results and a group's points exceed the memory limit
///               corruption, io_error, cancelled
/// Cost: for one point a few pages (find_triangles()), for a group of points close together the pages
/// of their region, each once. With `vertices` the cost of Detail is added (select/detail.h).
[[nodiscard]] LocateResult locate(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                                  const LocateRequest& request = {});

}  // namespace ptin
