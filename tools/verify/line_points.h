// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points along breaklines and the boundary, and how far a TIN passes from them.
#pragma once

#include <functional>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "tools/verify/line_samples.h"

namespace ptin::tools {

struct LinePoint {
  double x = 0.0, y = 0.0;  ///< Grid.
  double height = 0.0;      ///< Between the heights of the piece's ends.
};

/// Points in a box along the pieces of lines, at most 257 on each; by y.
/// @param height_at  The height of the sample at an end of a piece.
[[nodiscard]] std::vector<LinePoint> points_along(
    const LineSamples& lines, const GridBox& box,
    const std::function<double(GridPoint)>& height_at);

/// The vertical distance of each point from the surface of a TIN; infinite where it has none. Points
/// lie on edges of the full TIN, so triangles are taken as closed, and a little wider than they are.
[[nodiscard]] std::vector<double> distances_from(const Tin& tin, const HeightEncoding& heights,
                                                 const std::vector<LinePoint>& points);

}  // namespace ptin::tools
