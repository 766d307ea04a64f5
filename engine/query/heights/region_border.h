// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points that the border of a region shares with triangles.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/query/select/polygon_sides.h"
#include "engine/query/select/region.h"

namespace ptin {

/// x, y in grid units, and a value.
using ValuedPlace = std::array<double, 3>;

/// The sides of a window or a polygon, on the grid. What a closed triangle and a closed region share
/// is bounded by corners of the triangle, and by ends of what single sides share with the triangle: a
/// value that is linear on the triangle is largest at one of these. Threads: immutable.
class RegionBorder {
 public:
  /// @param bounds  Of the domain: sides of a window far beyond it are taken to near it.
  /// REQUIRES: the region is a window or a polygon.
  RegionBorder(const Region& region, const AffineMap& map, const GridBox& bounds);

  /// Appends the ends of what each side shares with a closed triangle, with their values; what is as
  /// near to the triangle as rounding is shared. Where an end lies on an edge its value lies between
  /// those of the edge's ends, the same in both triangles at the edge.
  /// @param triangle  Counter-clockwise.
  /// Cost: the sides near the triangle.
  void visit_shared(const std::array<ValuedPlace, 3>& triangle,
                    std::vector<ValuedPlace>& ends) const;

 private:
  /// @param rings  On the grid.
  explicit RegionBorder(const std::vector<std::vector<MapPoint>>& rings);
  void add_shared(const std::array<ValuedPlace, 3>& triangle, const PolygonSides::Side& side,
                  std::vector<ValuedPlace>& ends) const;

  PolygonSides sides_;
  std::optional<PolygonSides::Side> place_;  ///< The whole region, where it is one place.
};

}  // namespace ptin
