// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of isolines: `ptin isoline`, and `isolines` over HTTP.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

struct IsolineQuestion {
  IsolineRequest request;
  Levels levels;
  RegionText region;
};
void add_isolines(Parameters& rows, IsolineQuestion& question);

/// A state of isolines that change while splits arrive; written as the fields `step`, `splits` and
/// `error`.
struct IsolineStep {
  std::uint64_t step = 0;        ///< From 0.
  std::uint64_t splits = 0;      ///< Applied to T0 by then.
  double certified_error = 0.0;  ///< Of the TIN whose isolines these are.
};
/// A line as a feature.
struct IsolineRow {
  std::uint64_t id = 0;
  double elevation = 0.0;
  bool ring = false;
  const IsolineStep* step = nullptr;  ///< Null: there are no steps.
};
[[nodiscard]] Fields<IsolineRow> isoline_row_fields();
/// What lies between two levels, as a feature.
struct BandRow {
  std::uint64_t id = 0;
  double low = 0.0, high = 0.0;
};
[[nodiscard]] Fields<BandRow> band_row_fields();

struct IsolineAnswer {
  const Isolines* isolines;
  std::uint64_t lines = 0, rings = 0, points = 0;  ///< Written.
};
[[nodiscard]] Fields<IsolineAnswer> isoline_fields();
struct BandAnswer {
  std::vector<double> levels;
  std::uint64_t features = 0, polygons = 0;
};
[[nodiscard]] Fields<BandAnswer> band_fields();

}  // namespace ptin::ask
