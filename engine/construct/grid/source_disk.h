// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much disk a source takes while a terrain is built from it.
#pragma once

#include <cstdint>

namespace ptin {

/// Bytes of temporary files for a source; only `tiles_of_vertex` speaks of the files of tiles.
struct SourceDisk {
  std::uint64_t while_reading = 0;  ///< At most, while it is read and sorted, before tiles begin.
  std::uint64_t spooled = 0;        ///< Of those, the bytes when the last point has been read.
  std::uint64_t kept = 0;           ///< While tiles are built, until the build ends.
  double tiles_of_vertex = 62.0;    ///< A vertex, for files of tiles: measured, with some room.
  bool is_there = false;            ///< The source has been read: `kept` is on the disk already.
  bool is_estimate = false;         ///< The number of points is estimated.
  /// True when much less may be needed: points may be left out, or an interrupted build may have
  /// done a part of the work. A disk that is too small for these bytes is then no reason to refuse.
  bool may_be_less = false;
};

}  // namespace ptin
