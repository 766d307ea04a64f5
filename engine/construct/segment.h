// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of a tile above the leaves, on their way to final attributes.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/construct/tile_tree.h"
#include "storage/record.h"

namespace ptin {

/// Final error and deviation of a record, as stored.
struct RecordBounds {
  float error = 0.0F;
  float deviation = 0.0F;
};

/// The segment of an inner tile after its collapses. Its records are numbered behind the foreign
/// ones, those that its children pushed up: record i of `records` has number foreign.size() + i.
struct InnerSegment {
  TileId id;
  std::vector<RecordBounds> foreign;  ///< In the order of the children; final for those of leaves.
  std::vector<std::uint32_t> child_begin;  ///< Where each child's begin in `foreign`.
  std::vector<VertexSplit>
      records;  ///< In the order of the collapses; error and deviation own parts so far.
  std::vector<std::uint32_t>
      dependencies;  ///< Numbers; record i depends on those before dependency_end[i].
  std::vector<std::uint32_t> dependency_end;
  std::vector<std::uint32_t>
      exported;  ///< Numbers of the records that this tile pushed up in turn.
};

}  // namespace ptin
