// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether coordinates lie where their CRS is used: northings that stand before eastings show so.
#pragma once

#include <cstdint>

#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

/// True where the middle of a terrain lies outside of the area in which its CRS is used, and inside
/// of it with x and y exchanged. False too where the frame has no CRS, or nobody knows its area.
/// @param columns, rows  Grid steps from the westernmost to the easternmost sample, and from the
///                       southernmost to the northernmost.
/// Cost: milliseconds (PROJ's database). Never throws for a CRS that GDAL does not understand.
[[nodiscard]] bool are_axes_exchanged(const TerrainFrame& frame, std::int64_t columns,
                                      std::int64_t rows);

}  // namespace ptin
