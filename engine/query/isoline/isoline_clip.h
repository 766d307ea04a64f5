// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines cut at the border of a window, so that two windows that share a side get the same bits
// there.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/select/region.h"

namespace ptin {

/// The part of the segment a -> b in the closed window; none when they share at most one point. A
/// cut on a side has that side's coordinate, and the other one interpolated between the ends in
/// lexicographic order: it depends on the segment and that side alone.
[[nodiscard]] std::optional<std::pair<MapPoint, MapPoint>> clip_segment(MapPoint a, MapPoint b,
                                                                        const Window& window);

/// The parts of a line in the closed window, in its direction; each of at least two points, none
/// repeated in a row. A ring (its last point is its first) that lies inside stays one; the part
/// that holds its first point otherwise is one part, not two.
struct ClippedParts {
  std::vector<std::vector<MapPoint>> parts;
  bool whole = false;  ///< All of the line is inside: `parts` holds it as it was.
};
[[nodiscard]] ClippedParts clip_line(std::span<const MapPoint> line, const Window& window);

}  // namespace ptin
