// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest or lowest point of a window, and its highest vertices, best first over the index.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/select/region.h"
#include "engine/query/walk/point_state.h"

namespace ptin {

struct HighestRequest {
  std::optional<Window> window;  ///< Map units, closed. None: the whole terrain.
  bool lowest = false;           ///< The lowest instead; "highest" below then means that.
  std::uint32_t listed = 1;      ///< How many of the highest vertices to list, >= 1.
  DetailRequest detail;          ///< Of which TIN the highest point is wanted.
  QueryLimits limits;
};

struct HeightAt {
  MapPoint position;  ///< Map units.
  double height = 0;  ///< Height's unit.
};

struct HighestResult {
  /// Unless it is surface there is no point: the window lies outside of the domain (its hull, not
  /// its box), or holds nothing but voids.
  PointState state = PointState::kSurface;
  /// The highest point of the surface in the window: one of several, when there are. At a vertex,
  /// or on the window's border, where an edge crosses it or at its corner.
  HeightAt point;
  bool at_vertex = false;
  /// The source's highest lies between, where both are surface; equal when exact.
  double height_min = 0, height_max = 0;
  /// The highest vertices in the window that touch the surface, falling; fewer when it holds fewer.
  /// Of equal ones those that are found first: the same for the same file and request.
  std::vector<HeightAt> vertices;
  /// Of the TIN that was asked from the source, at samples and at any point. 0 when exact.
  double certified_error = 0, certified_deviation = 0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.
  QueryCost cost;
};

/// Finds them. Heights at vertices are as stored; on the window's border they are interpolated,
/// with the rounding of a few operations.
/// @throws Error invalid_argument    the window is inverted or not finite; no vertex is asked for;
///                                   as Detail
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: the pages and nodes whose height interval reaches above the last of the highest vertices:
/// those around them, and coarse records that reach out to higher ground outside; n log n for n
/// vertices. With voids, or at a level of detail, a point location (locate.h) for each vertex
/// besides, in batches; of V vertices that touch no surface and are higher, in O(log V) searches.
/// An index other than the packed R-tree reads the same pages after a search of all that meet the
/// window. With `vertices` that of finding the last one is added (detail.h).
[[nodiscard]] HighestResult highest(const OpenedTerrain& terrain, const HighestRequest& request);

}  // namespace ptin
