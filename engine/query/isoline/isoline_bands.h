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

/// A surface as plain arrays, borrowed: x, y in map units, z in the height's unit; triangles
/// counter-clockwise, meeting in whole edges.
struct SurfaceArrays {
  std::span<const std::array<double, 3>> vertices;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// One polygon of a band. Band b lies from level b - 1, which belongs to it, up to level b, which
/// does not. Band 0 lies below the first level, the last band from the last level up.
struct BandPolygon {
  std::uint32_t band = 0;
  /// The shell, counter-clockwise, then the holes, clockwise. Each ring ends with its first point,
  /// repeats no other point, and touches other rings in single points at most.
  std::vector<std::vector<MapPoint>> rings;
};

/// The polygons of all bands, ordered by band. Their borders are the isolines and the border of the
/// surface. The isolines are those of isoline/isoline.h: a vertex at a level counts as above it,
/// and cuts are the same but for rounding in map units. Together the polygons cover the surface,
/// and their interiors share no point. What has no area (a peak or a ridge exactly at a level) is
/// left out.
/// Valid by the rules of OGC simple features, as long as doubles tell neighbouring cuts apart: cuts
/// closer to each other than about 1e-16 of a coordinate may fall together.
/// @param levels  Height's unit, ascending, each once.
/// @throws Error resource_exhausted  more than the context's memory
///               cancelled
/// Cost: O(n log n) in triangles and cuts.
[[nodiscard]] std::vector<BandPolygon> band_polygons(const SurfaceArrays& surface,
                                                     std::span<const double> levels,
                                                     const QueryContext& context);

}  // namespace ptin
