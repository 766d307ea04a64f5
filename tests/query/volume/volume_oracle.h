// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes from all triangles, or all pairs of them, in rationals: slow and obviously right. What two
// convex polygons share is the hull of the corners that lie in both and of the crossings of their
// sides.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/select/region.h"
#include "storage/store_file.h"
#include "tests/query/line_oracle.h"

namespace ptin::reference {

using RationalPolygon = std::vector<RationalPoint>;

/// A triangle in map units with heights that are linear on it.
struct RationalTriangle {
  std::array<RationalPoint, 3> corners;  ///< Counter-clockwise.
  std::array<Rational, 3> heights;
  bool is_surface = false;
  double low[2]{}, high[2]{};  ///< About its box.

  [[nodiscard]] Rational at(const RationalPoint& p) const;
};
[[nodiscard]] std::vector<RationalTriangle> rational_triangles(const Tin& tin,
                                                               const StoreFacts& facts);

struct RationalVolume {
  Rational cut, fill, surface_area, void_area;
};
/// Against a level. @param ring  Of a simple polygon, map units; none: everywhere.
[[nodiscard]] RationalVolume volume_above(const std::vector<RationalTriangle>& triangles,
                                          double level,
                                          const std::vector<std::vector<MapPoint>>& rings);
/// Between two terrains.
[[nodiscard]] RationalVolume volume_between(const std::vector<RationalTriangle>& here,
                                            const std::vector<RationalTriangle>& there,
                                            const std::vector<std::vector<MapPoint>>& rings);

}  // namespace ptin::reference
