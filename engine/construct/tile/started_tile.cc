// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/started_tile.h"

#include <algorithm>
#include <utility>

#include "engine/construct/tile/part_surface.h"

namespace ptin {

GroundStep largest_step(const GroundMetric& ground, const GridBox& rows) {
  GroundStep largest = ground.at(rows.min_y);
  if (ground.is_uniform()) {
    return largest;
  }
  // Between two of so many rows, at most 180 degrees / 64 apart, a step grows by less than 0.13 %.
  constexpr int kRows = 64;
  constexpr double kBetween = 1.0013;
  for (int i = 1; i <= kRows; ++i) {
    const double y = rows.min_y + (static_cast<double>(rows.max_y) - rows.min_y) * i /
                                      static_cast<double>(kRows);
    const GroundStep step = ground.at(y);
    largest = {std::max(largest.x, step.x), std::max(largest.y, step.y)};
  }
  return {largest.x * kBetween, largest.y * kBetween};
}

StartedTile start_part(Tin&& part, const MeasureUnits& units, const ConvexHull& hull,
                       const GroundMetric* ground, std::span<const std::uint8_t> fixed_sides) {
  StartedTile started;
  started.tile.units = units;
  started.tile.tin = std::move(part);
  for (const Vertex& v : started.tile.tin.vertices) {
    started.box = united(started.box, v.position);
  }
  std::optional<PartBorder> border;
  if (ground != nullptr) {
    border.emplace();
    border->goes_on = [&hull](GridPoint a, GridPoint b) { return !hull.has_on_border(a, b); };
    border->step = largest_step(*ground, started.box);
    border->witnesses =
        find_border_witnesses({started.tile.tin, border->goes_on, {}, border->step});
  }
  start_tile(started.tile, border ? &border->witnesses : nullptr);
  started.full =
      std::make_unique<PartSurface>(started.tile.tin, units.heights, std::move(border),
                                    FixedGaps(started.tile.tin, fixed_sides, units.heights));
  return started;
}

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
