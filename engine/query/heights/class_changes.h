// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which samples a level of detail moves from surface to void, or from void to surface.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/geometry/infinity.h"
#include "engine/memory_units.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/select/region.h"

namespace ptin {

struct ClassChangesRequest {
  std::optional<Region> region;  ///< Where samples are counted, map units; none: everywhere.
  DetailRequest detail;          ///< The level of detail that is held against the finest TIN.
  /// How far along x and along y, in map units, the border between surface and void may be from
  /// that of the finest TIN, either way. What is farther from a border than that is not looked at.
  std::array<double, 2> reach{kInfinity, kInfinity};
  QueryLimits limits{.memory_bytes = kMemoryOfParts};  ///< Limits of one part of the terrain.
};

/// Samples are the vertices of the finest TIN of the file. One with a surface triangle is surface,
/// and stays so where a closed surface triangle of the level holds it. Any other is void, and stays
/// so where a closed void triangle holds it; on an edge between two surface triangles it does not.
struct ClassChanges {
  std::uint64_t to_void = 0;
  std::uint64_t to_surface = 0;
  QueryCost cost;
};

/// Counts the samples of the region that change their class at a level of detail. Zeros without
/// reading where the terrain has no voids.
/// @throws Error invalid_argument    the detail or the region means nothing; a reach is negative or
///                                   NaN
///               resource_exhausted  what a single position needs does not fit the limit
///               corruption, io_error, cancelled
/// Cost: the stars of the level where samples are counted, and those of the finest TIN within twice
/// the reach of a border.
[[nodiscard]] ClassChanges class_changes(const OpenedTerrain& terrain,
                                         const ClassChangesRequest& request);

}  // namespace ptin
