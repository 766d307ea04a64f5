// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines and rings of one CRS in another one, where their straight sides are bent.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/query/questions.h"

class OGRCoordinateTransformation;
class OGRSpatialReference;

namespace ptin::tools {

/// Takes places from one CRS to another one. A place that has none there becomes NaN.
using PlaceTransform = std::function<void(std::span<MapPoint>)>;
/// The transformation that GDAL makes. `way` outlives it.
[[nodiscard]] PlaceTransform places_by(OGRCoordinateTransformation& way);

/// Whether x of a CRS is a longitude in degrees.
[[nodiscard]] bool has_degrees(const OGRSpatialReference& crs);

/// The place that transformed sides go to.
struct SideTarget {
  double most_bend = 0.0;  ///< Map units, > 0; infinite: sides are of no interest, corners alone.
  /// How far x is around the Earth, where it jumps by that at the antimeridian: 360 of longitudes in
  /// degrees. 0: it does not.
  double turn = 0.0;
  /// x where sides come from is one: a side goes the shorter way around, from 179 to -179 over 180.
  bool source_turns = false;
  /// Bounds of a terrain in degrees: what reaches beyond 180 is taken into their turn.
  std::optional<Window> bounds;
  std::size_t most_points = std::size_t{1} << 22;
};

/// The target of a terrain: bends of a hundredth of the distance between its samples.
/// @param turn  As SideTarget::turn.
[[nodiscard]] SideTarget side_target(const StoreFacts& facts, double turn);

/// A path of straight sides of one CRS in another one: its corners, in their order, and between them
/// as many places of its sides as it takes for no place of a side to be farther from the path than
/// `target.most_bend`. Sides are looked at in at least three places, long ones in fifteen, and again
/// between the places that were added; a bend that all of these miss is not seen. The places of a
/// side are the same whichever end it begins at, so polygons that share a side go on sharing it.
///
/// An x that turns goes on from one place to the next: a path across the antimeridian does not jump.
/// @throws Error invalid_argument    a corner, or a part of a side, is nowhere in the other CRS; a
///                                   side breaks there; a ring is none there, as one around a pole
///               resource_exhausted  there are more points than `target.most_points`
/// Cost: four or more transformed places a side.
[[nodiscard]] std::vector<MapPoint> transformed_sides(std::span<const MapPoint> path,
                                                      const PlaceTransform& transform,
                                                      const SideTarget& target);

/// Brings places, each for itself, into the turn of the circle that the target's bounds lie in.
void turn_to_bounds(std::span<MapPoint> places, const SideTarget& target);

/// The transformation of a geometry of another CRS.
struct Transformed {
  std::string from;           ///< The name of its CRS.
  double bent_at_most = 0.0;  ///< Map units of the terrain: how far sides may be off.
};

}  // namespace ptin::tools
