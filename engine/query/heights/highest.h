// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest or lowest point of a window or a polygon, and its highest vertices, found best first
// over the index.
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
  std::optional<Region> region;  ///< A window or a polygon, map units, closed. None: everywhere.
  bool lowest = false;           ///< Ask for the lowest instead; "highest" below then means that.
  std::uint32_t listed = 1;      ///< How many of the highest vertices to list, >= 1.
  DetailRequest detail;          ///< The TIN of which the highest point is wanted.
  QueryLimits limits;
};

struct HeightAt {
  MapPoint position;  ///< Map units.
  double height = 0;  ///< Height's unit.
};

struct HighestResult {
  /// kSurface: `point` is set. kOutside: the region lies outside of the domain, which is the convex
  /// hull and not its box. kVoid: the region holds nothing but voids.
  PointState state = PointState::kSurface;
  /// The highest point of the surface in the region; of several the first of `vertices`, or else
  /// one. It is a vertex, or lies on the border of the region: where an edge crosses it, or at a
  /// corner of the region.
  HeightAt point;
  bool at_vertex = false;
  /// Bounds of the height of the source's highest point, as far as both TINs are surface; equal
  /// when exact.
  double height_min = 0, height_max = 0;
  /// The highest vertices in the region that touch the surface, by falling height; fewer than asked
  /// for when the region holds fewer. Among equal heights the vertex farthest south comes first,
  /// then the one farthest west, in any file of the same TIN.
  std::vector<HeightAt> vertices;
  /// How far the TIN that was asked is at most from the source, at samples and at any point,
  /// height's unit. 0 when exact.
  double certified_error = 0, certified_deviation = 0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.
  QueryCost cost;
};

/// Finds the highest point and the highest vertices. Heights at vertices are as stored; on the
/// border of the region they are interpolated, exactly but for three roundings. A vertex on the
/// border of the region, as GridRegion has it, lies in it.
/// @throws Error invalid_argument    the region has no inside; no vertex is asked for; as GridRegion
///                                   and Detail
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: the nodes and pages with a star that reaches above the last vertex listed, or just to it
/// and with the box farther south (of nodes those that meet the region's box, of pages the region);
/// n log n for n vertices. Memory: the vertices listed, and a page.
/// With `vertices` the cost of Detail is added (select/detail.h).
[[nodiscard]] HighestResult highest(const OpenedTerrain& terrain, const HighestRequest& request);

}  // namespace ptin
