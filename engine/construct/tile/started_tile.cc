// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/started_tile.h"

namespace ptin {

MeasureUnits measure_units(const TerrainFrame& frame, double void_slope) {
  MeasureUnits units;
  units.heights = frame.heights;
  units.quantum_code = frame.height_quantum / frame.heights.step;
  units.void_slope_code = void_slope / frame.heights.step;
  // Heights of float32 are never taken for exact: they may look like multiples of the quantum and
  // be only near to them, and claiming exact arithmetic saves no more than a bound of rounding.
  units.exact_codes = frame.heights.type == HeightType::int32;
  return units;
}

}  // namespace ptin
