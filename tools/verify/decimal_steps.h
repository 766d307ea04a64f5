// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coordinates and heights of a source in steps of a terrain, by digits of their own, for
// `verify --against`.
#pragma once

#include "engine/construct/grid/decimal.h"

namespace ptin::tools {

/// A decimal in whole steps from `origin`. Where the steps are a power of ten it is rounded half away
/// from zero in decimals, as it is written: a double would lie on one side of the middle by chance.
/// Else it is rounded from the origin.
[[nodiscard]] double steps_of(Decimal d, double origin, double step);

}  // namespace ptin::tools
