// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether coordinates as doubles tell the steps of a grid apart.
#pragma once

#include <cstdint>
#include <string>

#include "engine/geometry/affine.h"

namespace ptin {

/// Steps that a coordinate may be away from 0: there a double is off by a sixteenth of a step at
/// most, and still rounds to the right one.
inline constexpr double kMostStepsFromZero = 0x1p49;

/// @param columns, rows  Grid steps from the first to the last sample.
/// @param remedy         What to do, after "; ".
/// @throws Error invalid_argument  the coordinates are farther from 0 than that
void require_resolvable(const AffineMap& map, std::int64_t columns, std::int64_t rows,
                        const std::string& remedy, const std::string& context);

}  // namespace ptin
