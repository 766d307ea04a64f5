// SPDX-License-Identifier: GPL-3.0-or-later
//
// A point as its file gives it, and what a file of points declares about all of its points.
#pragma once

#include <optional>
#include <string>

#include "engine/construct/grid/decimal.h"

namespace ptin {

/// A point of a source, before it is put on the grid; CRS units and the height's unit.
struct SourcePoint {
  Decimal x, y, z;
};

/// Units that a source names itself, as LandXML does: as height_unit_named() (engine/crs) has them;
/// "" where it is silent.
struct DeclaredUnits {
  std::string plane, heights;
  friend bool operator==(const DeclaredUnits&, const DeclaredUnits&) = default;
};

/// A grid that a source brings along: LAS coordinates are whole steps from an offset.
struct SourceLattice {
  double unit = 0.0;                      ///< CRS units, > 0.
  double origin_x = 0.0, origin_y = 0.0;  ///< CRS units.
};

/// What a source declares before its first point is read.
struct PointStreamFacts {
  std::string crs;           ///< Anything GDAL understands; "" when the source does not say.
  std::string vertical_crs;  ///< Likewise, where the source names it apart from `crs`.
  DeclaredUnits units;       ///< What the source says of them beside a CRS.
  /// Digits after the point that coordinates and heights are declared to have: at least so many are
  /// kept.
  int plan_decimals = 0;
  int height_decimals = 0;
  /// Set where the file's steps are no power of ten, or its offset is not a whole number of steps.
  /// The grid is then this lattice where all sources have it, and `plan_decimals` means nothing.
  std::optional<SourceLattice> lattice;
};

}  // namespace ptin
