// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coordinates and heights of a source in steps of a terrain, by digits of their own, for
// `verify --against`.
#pragma once

#include <optional>

#include "engine/construct/grid/source_point.h"
#include "engine/geometry/affine.h"

namespace ptin::tools {

/// A decimal in whole steps from `origin`. Where the steps are a power of ten it is rounded half away
/// from zero in decimals, as it is written: a double would lie on one side of the middle by chance.
/// Else it is rounded from the origin.
[[nodiscard]] double steps_of(Decimal d, double origin, double step);

/// The position of a point in whole steps of a terrain's grid, which may be another one.
/// @param resolution  The step that the build was given: it counts from 0, not from the grid's origin,
///                    which decides where a position in the middle between two grid points goes.
[[nodiscard]] MapPoint grid_position(const SourcePoint& p, const AffineMap& map,
                                     std::optional<double> resolution);

}  // namespace ptin::tools
