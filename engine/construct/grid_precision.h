// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether coordinates as doubles tell the steps of a grid apart.
#pragma once

#include <cstdint>
#include <string>

#include "engine/geometry/affine.h"

namespace ptin {

/// @param columns, rows  Grid steps from the first to the last sample.
/// @param remedy         What to do, after "; ".
/// @throws Error invalid_argument  a double at these coordinates is off by more than a hundredth of
///                                 a step
void require_resolvable(const AffineMap& map, std::int64_t columns, std::int64_t rows,
                        const std::string& remedy, const std::string& context);

}  // namespace ptin
