// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points in memory: read from streams, snapped to the grid, merged where they fall together. What
// PointBuckets sorts on disk is held against it.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Distinct points on the grid, and how they came there.
struct PointSet {
  TerrainFrame frame;
  std::vector<GridPoint> positions;   ///< In ascending order of key_of().
  std::vector<HeightBits> heights;    ///< Beside `positions`.
  std::uint64_t source_points = 0;    ///< Read and not left out.
  std::uint64_t left_out_points = 0;  ///< By their class or bounds, withheld, without a height.
  std::uint64_t merged_points = 0;    ///< Source points less positions.
  /// How far a point moved at most: in plan when it was snapped to the grid (CRS units; 0 where the
  /// grid keeps every digit), and in height when it was merged (height's unit).
  double largest_shift_plan = 0.0;
  double largest_shift_height = 0.0;
};

/// Reads the points of all files (point_stream.h says which) and puts them on one grid.
///
/// By the rules of PointSource::sort().
/// @param progress  Called now and then with points done and in all, or bytes of text (0 when a .gz
/// hides that); may be empty.
/// @throws Error  as PointSource
/// Cost: O(n log n), about 0.4 us a point; 80 bytes a point while it runs.
[[nodiscard]] PointSet read_points(
    const std::vector<std::string>& paths, const SourceOptions& options,
    const std::stop_token& stop = {},
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

}  // namespace ptin
