// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines cut at the border of a region, so that two regions that share a side get the same bits there.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/select/polygon_sides.h"
#include "engine/query/select/region.h"

namespace ptin {

/// The part of the segment a -> b in the closed window; none when they share at most one point. A
/// cut on a side of the window has that side's coordinate. Its other coordinate is interpolated
/// between the ends in lexicographic order, so it depends on the segment and that side alone.
[[nodiscard]] std::optional<std::pair<MapPoint, MapPoint>> clip_segment(MapPoint a, MapPoint b,
                                                                        const Window& window);

/// The parts of a line in a closed region, in the direction of the line. Each part has at least two
/// points, and none repeated in a row. A ring (its last point is its first) that lies inside stays a
/// ring. The first point of a ring that is cut divides no part.
struct ClippedParts {
  std::vector<std::vector<MapPoint>> parts;
  bool whole = false;  ///< The whole line is inside; `parts` holds it unchanged.
};
[[nodiscard]] ClippedParts clip_line(std::span<const MapPoint> line, const Window& window);

/// Cuts lines at a polygon by the even-odd rule; its border belongs to it, with what is as near to it
/// as rounding. A cut on a side along x or y has that side's coordinate, as that of a window; others
/// depend on the ends of the segment and of the side alone. Threads: immutable.
class PolygonClip {
 public:
  explicit PolygonClip(const Polygon& polygon) : sides_(polygon.rings) {}
  /// Cost: the sides near the line's segments, and for each segment beside one that meets a side those
  /// that reach its y.
  [[nodiscard]] ClippedParts clip(std::span<const MapPoint> line) const;

 private:
  class OfSegment;
  PolygonSides sides_;
};

}  // namespace ptin
