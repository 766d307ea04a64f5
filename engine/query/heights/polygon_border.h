// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points that the border of a polygon shares with triangles.
#pragma once

#include <array>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/heights/window_clip.h"
#include "engine/query/select/polygon_sides.h"
#include "engine/query/select/region.h"

namespace ptin {

/// The sides of a polygon, on the grid. What a closed triangle and a closed polygon share is bounded
/// by corners of the triangle, and by ends of what single sides share with the triangle: a value that
/// is linear on the triangle is largest at one of these. Threads: immutable.
class PolygonBorder {
 public:
  PolygonBorder(const Polygon& polygon, const AffineMap& map);

  /// Appends the ends of what each side shares with a closed triangle, their values interpolated
  /// between those of its corners; what is as near to the triangle as rounding is shared.
  /// @param triangle  Counter-clockwise.
  /// Cost: the sides near the triangle.
  void visit_shared(const std::array<ClippedCorner, 3>& triangle,
                    std::vector<ClippedCorner>& ends) const;

 private:
  PolygonSides sides_;
};

}  // namespace ptin
