// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/started_tile.h"

namespace ptin {

MeasureUnits measure_units(const TerrainFrame& frame, double void_slope) {
  MeasureUnits units;
  units.heights = frame.heights;
  units.quantum_code = frame.height_quantum / frame.heights.step;
  units.void_slope_code = void_slope / frame.heights.step;
  // Float32 heights may look like whole numbers and not be (the quantum is only what they are near
  // to), and what a claim of exact arithmetic saves is rounding alone.
  units.exact_codes = frame.heights.type == HeightType::int32;
  return units;
}

}  // namespace ptin
