// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether coordinates as doubles tell the steps of a grid apart.
#pragma once

#include <cstdint>
#include <string>

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

}  // namespace ptin
