// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much disk a source takes while a terrain is built from it.
#pragma once

#include <cstdint>

namespace ptin {

/// Bytes a vertex that noise takes in the output, with some room: random float64 heights on a grid 44,
/// whole numbers of 30 random bits 23, and 34 where voids are scattered among them; points with six random
/// digits after the point in each coordinate 94. Ordinary terrains take 14 to 40.
inline constexpr double kRasterOutputOfVertex = 47.0, kPointOutputOfVertex = 99.0;

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
