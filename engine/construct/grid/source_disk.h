// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much disk a source takes while a terrain is built from it.
#pragma once

#include <cstdint>

namespace ptin {

/// What noise takes in the output, with some room, bytes a vertex: heights of 30 random bits on a grid
/// 51, points with six random digits after the point in each coordinate 98. Ordinary terrains take 18
/// to 45.
inline constexpr double kRasterOutputOfVertex = 54.0, kPointOutputOfVertex = 104.0;

/// Bytes of temporary files for a source; only `tiles_of_vertex` speaks of the files of tiles.
struct SourceDisk {
  std::uint64_t while_reading = 0;  ///< At most, while it is read and sorted, before tiles begin.
  std::uint64_t spooled = 0;        ///< What of that is there when the last point has been read.
  std::uint64_t kept = 0;           ///< While tiles are built, until the build ends.
  double tiles_of_vertex = 62.0;    ///< A vertex, for files of tiles: measured, with some room.
  double output_of_vertex = kRasterOutputOfVertex;  ///< Bytes of the output a vertex, at most.
  bool is_there = false;     ///< The source has been read: `kept` is on the disk already.
  bool is_estimate = false;  ///< The number of points is estimated.
  /// True when much less may be needed: points may be left out, or an interrupted build may have
  /// done a part of the work. A disk that is too small for these bytes is then no reason to refuse.
  bool may_be_less = false;
};

}  // namespace ptin
