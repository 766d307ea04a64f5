// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile under construction: a TIN, what its triangles carry, and the records that came off.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/construct/tile/cost.h"
#include "engine/construct/tile/sample_lists.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "storage/record.h"

namespace ptin {

/// What a triangle carries upwards (saturation, engine/DESIGN.md, section 2.2): the attributes of the record
/// that created it. The box is kept here because every evaluation of a collapse asks for it; the
/// rest is read from the record.
struct CarriedState {
  GridBox roi;  ///< Empty for a triangle of the full TIN.
  std::uint32_t record =
      kNone;           ///< Index into Tile::records; kNone for a triangle of the full TIN.
  SampleSlot samples;  ///< Removed samples inside this triangle.
  /// Length of the longest chain of collapses that ends here: 1 and the rank of its record, 65 535
  /// at most; 0 for a triangle of the full TIN.
  std::uint16_t chain = 0;
  bool holds_heights = false;  ///< Some of them have a height ...
  bool holds_voids = false;    ///< ... and some have none.
};

/// What a triangle carries that the record with index `id` has made.
inline void carry_record(CarriedState& carried, const VertexSplit& r, std::uint32_t id) noexcept {
  carried.roi = r.roi;
  carried.record = id;
  carried.chain = static_cast<std::uint16_t>(r.rank == UINT16_MAX ? r.rank : r.rank + 1);
}

/// Per-vertex facts of a tile.
struct VertexState {
  float depth = 0.0F;        ///< As Sample::depth.
  std::uint16_t degree = 0;  ///< Neighbours in the mesh.
  bool locked = false;       ///< On a seam: may be collapsed into, is not collapsed itself.
};

/// Constants of a build that measuring needs, in height codes.
struct MeasureUnits {
  HeightEncoding heights;
  double quantum_code = 1.0;     ///< One height quantum, as a difference of codes.
  double void_slope_code = 0.0;  ///< Height codes charged per ground unit of depth.
  bool exact_codes =
      false;  ///< Codes are integers, so that residuals of small stars have no rounding.

  /// What a sample of the wrong class is charged, in codes. A depth beyond the cut-off is infinite,
  /// and so is its charge, whatever the slope.
  [[nodiscard]] double charge(float depth) const noexcept {
    return std::isinf(depth) ? std::numeric_limits<double>::infinity()
                             : static_cast<double>(std::abs(depth)) * void_slope_code;
  }
};

/// A tile: everything that a collapse reads and changes. What is pushed up to a parent is the TIN,
/// `carried` (with the records it points to) and the samples.
struct Tile {
  Tin tin;
  std::vector<CarriedState> carried;      ///< Beside tin.triangles.
  std::vector<VertexState> vertex_state;  ///< Beside tin.vertices.
  SampleLists samples;
  /// In the order of the collapses; before them what a first pass left out (first_pass.h), one for
  /// each of its triangles, which no file keeps.
  std::vector<VertexSplit> records;
  /// What the own records of a tile of witnesses depend on, as indices into `records` (below that
  /// of the record itself): record i of the own ones on dependencies[dependency_end[i - 1]] ..
  /// [dependency_end[i]].
  std::vector<std::uint32_t> dependencies;
  std::vector<std::uint32_t> dependency_end;
  MeasureUnits units;
  /// Every grid position inside is a sample: rasters. Then samples join into blocks.
  bool samples_fill_grid = false;
  bool has_voids = false;  ///< Some triangle is void or some sample has no height.
};

/// Fills `carried` and `vertex_state` of a tile that holds the full TIN. Depths are +infinity where
/// `depths` is empty.
/// @param depths  Beside tin.vertices, unsigned; or empty.
void start_tile(Tile& tile, const std::vector<float>& depths);

}  // namespace ptin
