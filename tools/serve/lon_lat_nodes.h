// SPDX-License-Identifier: GPL-3.0-or-later
//
// Longitudes and latitudes over a terrain of a projected CRS, for a client that has no library of
// projections: a few nodes, and cubic between them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/affine.h"
#include "engine/query/questions.h"

namespace ptin::serve {

struct LonLatNodes {
  static constexpr std::size_t kAside = 4;
  /// Degrees of CRS84 at the thirds of a window, from its least x and y, row by row along x.
  /// Longitudes are within half a turn of the first, beyond 180 too.
  std::array<MapPoint, kAside * kAside> nodes{};
  /// Degrees by which either may be off between them: twice the most that was found at 49 places.
  double within = 0;

  /// Between the nodes: the polynomial of Lagrange through the four of each row, then through the
  /// four rows.
  /// @param x, y  Shares of the window, 0 to 1.
  [[nodiscard]] MapPoint at(double x, double y) const;
};

/// None of a geographic CRS, which has degrees; of one that is not known, or has no longitude
/// somewhere in the window; and where cubic is off by more than 0.005 degrees, as around a pole.
/// Cost: 65 places, and as lon_lat_of() to prepare.
[[nodiscard]] std::optional<LonLatNodes> lon_lat_nodes(const Window& window,
                                                       const CrsFacts& terrain);

}  // namespace ptin::serve
