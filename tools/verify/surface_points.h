// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points between samples, along breaklines or anywhere, and the heights that a TIN has there.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "tools/verify/line_samples.h"

namespace ptin::tools {

struct SurfacePoint {
  double x = 0.0, y = 0.0;  ///< Grid.
  /// What a TIN is held against; NaN: nothing.
  double height = std::numeric_limits<double>::quiet_NaN();
};

/// Points in a box along the pieces of lines, at most 257 on each, with the height between those of the
/// piece's ends; by y.
/// @param height_at  The height of the sample at an end of a piece.
[[nodiscard]] std::vector<SurfacePoint> points_along(
    const LineSamples& lines, const GridBox& box,
    const std::function<double(GridPoint)>& height_at);

/// The height of a triangle's plane where its corners have these weights, of any sum.
[[nodiscard]] double height_in(const Tin& tin, TriangleId t, const HeightEncoding& heights,
                               const std::array<double, 3>& weights);

/// The height of the closed surface triangle at each point, where several hold it the one nearest to
/// the point's own height; NaN where it is void. REQUIRES: points are sorted by y.
/// @param wider  Triangles reach beyond their edges by this share of their height: points on an edge are
///               beside it in doubles.
[[nodiscard]] std::vector<double> heights_at(const Tin& tin, const HeightEncoding& heights,
                                             const std::vector<SurfacePoint>& points, double wider);

}  // namespace ptin::tools
