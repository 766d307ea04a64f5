// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons between levels: the parts of a surface in each band of heights.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/select/accounting.h"

namespace ptin {

/// A surface as plain arrays: x, y in map units, z in the height's unit; triangles
/// counter-clockwise, meeting in whole edges.
struct SurfaceArrays {
  std::span<const std::array<double, 3>> vertices;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// One polygon of a band. Band b lies from level b - 1 (which belongs to it) up to level b; band 0
/// below the first level, the last one from the last level up.
struct BandPolygon {
  std::uint32_t band = 0;
  /// The shell, counter-clockwise, then holes, clockwise. Each ends with its first point, has no
  /// repeated point otherwise, and touches others in single points at most.
  std::vector<std::vector<MapPoint>> rings;
};

/// The polygons of all bands. Their borders are the isolines (isoline.h; the same rule: a vertex at
/// a level counts as above it, and the same cuts but for rounding in map units) and the border of
/// the surface. Together the polygons cover the surface, and their interiors share no point. What
/// has no area (a peak or a ridge exactly at a level) is left out.
/// Valid by the rules of OGC simple features, as long as neighbouring cuts are told apart by
/// doubles: cuts closer to each other than about 1e-16 of a coordinate may fall together.
/// @param levels  Ascending, each once.
/// Ordered by band.
/// @throws Error resource_exhausted  more than the context's memory
///               cancelled
/// Cost: O(n log n) in triangles and cuts.
[[nodiscard]] std::vector<BandPolygon> band_polygons(const SurfaceArrays& surface,
                                                     std::span<const double> levels,
                                                     const QueryContext& context);

}  // namespace ptin
