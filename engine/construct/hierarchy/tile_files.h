// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles between the stages of a build, on disk: what is pushed up, and segments that wait for
// tightening.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/hierarchy/tile_push.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// Writes what a tile pushes up. Degrees and locks are left out: join_tiles() makes them anew.
void write_pushed(ArrayFileWriter& out, const Tile& tile);
/// Reads it back.
/// @param units  Those of the build, which the file does not hold.
/// @throws Error corruption
[[nodiscard]] Tile read_pushed(ArrayFileReader& in, const MeasureUnits& units);

void write_segment(ArrayFileWriter& out, const InnerSegment& segment);

/// A segment in its mapped file. Its arrays are read in place and live as long as this object.
class SegmentFile {
 public:
  /// @throws Error corruption, io_error
  SegmentFile(const TileId& id, const std::string& path, const ArrayFileFacts& facts);
  [[nodiscard]] const SegmentView& view() const noexcept { return view_; }
  /// @throws Error corruption  as ArrayFileReader::require_undamaged
  void require_undamaged() const { file_.require_undamaged(); }

 private:
  ArrayFileReader file_;
  SegmentView view_;
};

}  // namespace ptin
