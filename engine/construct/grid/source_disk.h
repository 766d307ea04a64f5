// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a source takes of the disk while it is built from.
#pragma once

#include <cstdint>

namespace ptin {

/// What a source takes of the disk for temporary files, beside those of the tiles.
struct SourceDisk {
  std::uint64_t while_reading = 0;  ///< Bytes, before tiles are begun.
  std::uint64_t spooled = 0;        ///< Of those, when the last point has been read.
  std::uint64_t kept = 0;           ///< Until the build ends.
  double tiles_of_vertex = 55.0;    ///< Bytes of the files of tiles, by measurement with some room.
  bool is_there = false;            ///< It has been read: `kept` is on the disk already.
  bool is_estimate = false;
  /// By any part: points that are left out, or work that an interrupted build has done. So it is no
  /// reason to refuse.
  bool may_be_less = false;
};

}  // namespace ptin
