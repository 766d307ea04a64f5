// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a point of a source has a surface at all, by the empty circles of the points around it.
#pragma once

#include <functional>
#include <span>

#include "engine/geometry/point.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// True when no Delaunay triangle of the samples has the corner `p` and short sides alone. All
/// triangles of several points on one circle are taken for Delaunay triangles.
/// @param around       The samples of a box around `p`, `p` among them: all that a circle through `p`
///                     and two points near it may hold.
/// @param is_too_long  Whether a side is.
/// Cost: the square of the number of points near `p`, times that of the samples.
[[nodiscard]] bool is_lone_point(GridPoint p, std::span<const SourceSample> around,
                                 const std::function<bool(GridPoint, GridPoint)>& is_too_long);

}  // namespace ptin::tools
