// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of a tile of level 2 or more, on their way to final attributes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tile/tile_tree.h"
#include "storage/record.h"

namespace ptin {

/// Final error and deviation of a record, as stored.
struct RecordBounds {
  float error = 0.0F;
  float deviation = 0.0F;
  friend bool operator==(const RecordBounds&, const RecordBounds&) = default;
};

/// What a leaf showed of one record of a segment: error and deviation are at least these.
struct BoundsRaise {
  std::uint32_t record = 0;
  RecordBounds bounds;
};

/// The segment of a tile of level 2 or more after its collapses. Its records are numbered behind
/// the foreign ones, those that its children pushed up: record i of `records` has number
/// foreign.size() + i.
struct InnerSegment {
  TileId id;
  std::vector<RecordBounds> foreign;  ///< In the order of the children; final for those of level 1.
  std::vector<std::uint32_t> child_begin;  ///< Where each child's begin in `foreign`.
  std::vector<VertexSplit>
      records;  ///< In the order of the collapses; error and deviation own parts so far.
  std::vector<std::uint32_t>
      dependencies;  ///< Numbers; record i depends on those before dependency_end[i].
  std::vector<std::uint32_t> dependency_end;
  std::vector<std::uint32_t>
      exported;  ///< Numbers of the records that this tile pushed up in turn.
};

/// The same, held by somebody else: a file, mostly (tile_files.h).
struct SegmentView {
  TileId id;
  std::span<const RecordBounds> foreign;
  std::span<const std::uint32_t> child_begin;
  std::span<const VertexSplit> records;
  std::span<const std::uint32_t> dependencies;
  std::span<const std::uint32_t> dependency_end;
  std::span<const std::uint32_t> exported;
};

/// Errors and deviations of a segment while they are being tightened. Memory: 8 bytes a record.
class SegmentBounds {
 public:
  /// @param segment  Must live as long as this.
  explicit SegmentBounds(const SegmentView& segment);

  /// Takes maxima: the order of calls does not matter.
  void raise(std::span<const BoundsRaise> raises);
  /// The final bounds of what a child pushed up.
  void set_foreign(std::size_t child, std::span<const RecordBounds> bounds);

  /// Gives each record the maximum over itself and what it depends on. To be called once, when all
  /// leaves below have raised. Returns the bounds of the exported records, in their order.
  /// Cost: linear in the dependencies.
  [[nodiscard]] std::vector<RecordBounds> saturate();
  /// The records with these bounds.
  [[nodiscard]] std::vector<VertexSplit> records() const;

 private:
  const SegmentView* segment_;
  std::vector<RecordBounds> bounds_;  ///< Foreign ones, then own ones.
};

}  // namespace ptin
