// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of a tile of level 2 or more, on their way to final attributes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tile/record_stars.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/geometry/point.h"
#include "storage/record.h"
#include "storage/star.h"

namespace ptin {

/// Error and deviation of a record as stored: in the unit of heights, rounded up.
struct RecordBounds {
  float error = 0.0F;
  float deviation = 0.0F;
  friend bool operator==(const RecordBounds&, const RecordBounds&) = default;
};

/// What a leaf shows of one record of a segment: its error and deviation are at least `bounds`. The
/// record is known by its vertex, since its place among the records follows from all collapses before
/// it: a change elsewhere would move it, and change files that say the same.
struct BoundsRaise {
  GridPoint vertex;  ///< VertexSplit::u of the record.
  RecordBounds bounds;
};

/// Joins raises of several leaves: leaves one for each record, the maxima, by vertex key.
void combine(std::vector<BoundsRaise>& raises);

/// The segment of a tile of level 2 or more after its collapses. Its records depend on **foreign**
/// records, those that its children pushed up, and on one another; both kinds share one numbering.
/// First come the foreign records, child after child. Record i of `records`, the tile's own, has
/// number foreign.size() + i.
struct InnerSegment {
  TileId id;
  /// Bounds of the foreign records. Those from a child of level 1 are final; others become final by
  /// SegmentBounds::set_foreign().
  std::vector<RecordBounds> foreign;
  std::vector<std::uint32_t> child_begin;  ///< Where each child's begin in `foreign`.
  /// In the order of the collapses. Until tightening `error` is the own part over carried samples,
  /// and `deviation` is 0.
  std::vector<VertexSplit> records;
  /// Stars of the own records. Triangles name successors by number: own records saturate over
  /// these.
  RecordStars stars;
  std::vector<std::uint32_t> exported;  ///< Numbers of the records that this tile pushed up.
};

/// The same, in arrays of another owner: a mapped file (construct/hierarchy/tile_files.h).
struct SegmentView {
  TileId id;
  std::span<const RecordBounds> foreign;
  std::span<const std::uint32_t> child_begin;
  std::span<const VertexSplit> records;
  std::span<const RingCorner> corners;
  std::span<const std::uint32_t> successors;
  std::span<const std::uint32_t> ring_end;
  std::span<const std::uint32_t> exported;
};

/// Errors and deviations of a segment while they are being tightened. Memory: 8 bytes for each
/// record, foreign ones included, and 4 for each own one.
class SegmentBounds {
 public:
  /// @param segment  Must outlive this object, with its arrays.
  explicit SegmentBounds(const SegmentView& segment);

  /// Raises bounds of own records. Takes maxima, so the order of calls does not matter.
  /// REQUIRES: `raises` are those of combine().
  void raise(std::span<const BoundsRaise> raises);
  /// Takes the final bounds of the records that a child pushed up, in their order.
  /// @param child  Its place among the children.
  void set_foreign(std::size_t child, std::span<const RecordBounds> bounds);

  /// Gives each own record the maximum over itself and the records that it depends on. To be called
  /// once, when all leaves below have raised and all foreign bounds are final. Returns the bounds
  /// of the exported records, in their order. Cost: linear in the corners.
  [[nodiscard]] std::vector<RecordBounds> saturate();
  /// A copy of the own records with these bounds, and of their stars with deaths after these bounds.
  /// Final after saturate().
  [[nodiscard]] StarredRecords records() const;

 private:
  const SegmentView* segment_;
  std::vector<RecordBounds> bounds_;      ///< By number: of foreign records, then of own ones.
  std::vector<std::uint32_t> by_vertex_;  ///< Own records, ascending by vertex key.
};

}  // namespace ptin
