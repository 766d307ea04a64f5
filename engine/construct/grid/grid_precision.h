// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether coordinates as doubles tell the steps of a grid apart, and whether the grid keeps what they
// tell.
#pragma once

#include <cstdint>
#include <string>

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/geometry/affine.h"

namespace ptin {

/// How many steps a coordinate may lie from 0. Up to there a double is off by at most a sixteenth
/// of a step, and rounds to the right step.
inline constexpr double kMostStepsFromZero = 0x1p49;

/// Refuses a grid some coordinate of which lies more than kMostStepsFromZero steps from 0.
/// @param columns, rows  Grid steps from the first to the last sample.
/// @param remedy         What the caller can do; the message ends with "; " and this.
/// @param context        The path of the source, for the error.
/// @throws Error invalid_argument  as above
void require_resolvable(const AffineMap& map, std::int64_t columns, std::int64_t rows,
                        const std::string& remedy, const std::string& context);

/// Warns where the grid that was chosen for a source moved one of its points by more than a thousandth
/// of the unit of the CRS; in degrees, by more than a hundred-millionth, which is a millimetre.
/// @param shift  How far it moved the farthest, in plan, CRS units.
/// @param frame  With its map and its units.
/// @param file   The path of the source, for the warning.
void warn_of_shift(double shift, const TerrainFrame& frame, const std::string& file,
                   SourceWarnings& warnings);

}  // namespace ptin
