// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile before its first collapse, whatever its source.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// A leaf with the full TIN of its window, and the full surface under it.
struct StartedTile {
  Tile tile;
  std::unique_ptr<FullSurface> full;
  GridBox box;                     ///< Of all samples and the full surface.
  std::uint64_t lone_samples = 0;  ///< Samples that touch no surface triangle; treated as void.
};

/// Constants of measuring for a terrain.
/// @param void_slope  Height charged per ground unit of depth.
[[nodiscard]] MeasureUnits measure_units(const TerrainFrame& frame, double void_slope);

}  // namespace ptin
