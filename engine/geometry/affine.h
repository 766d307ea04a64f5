// SPDX-License-Identifier: GPL-3.0-or-later
//
// The affine map from the grid to the coordinate reference system.
#pragma once

namespace ptin {

/// A position in the units of the coordinate reference system (CRS).
struct MapPoint {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const MapPoint&, const MapPoint&) = default;
};

/// Axis-aligned map from grid to CRS: X = origin_x + step_x * x, Y = origin_y + step_y * y, steps >
/// 0. Grid y grows to the north; a source whose rows run to the south is turned over when it is
/// read.
struct AffineMap {
  double origin_x = 0.0;
  double origin_y = 0.0;
  double step_x = 1.0;
  double step_y = 1.0;
  friend bool operator==(const AffineMap&, const AffineMap&) = default;

  [[nodiscard]] MapPoint to_map(double grid_x, double grid_y) const noexcept {
    return {origin_x + step_x * grid_x, origin_y + step_y * grid_y};
  }
  /// The real-valued grid position of a map position; not rounded.
  [[nodiscard]] MapPoint to_grid(MapPoint p) const noexcept {
    return {(p.x - origin_x) / step_x, (p.y - origin_y) / step_y};
  }
};

}  // namespace ptin
