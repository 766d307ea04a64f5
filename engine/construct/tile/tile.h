// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile under construction: a TIN, what its triangles carry, and the records that came off.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/construct/tile/border_witnesses.h"
#include "engine/construct/tile/record_stars.h"
#include "engine/construct/tile/sample_lists.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "storage/record.h"

namespace ptin {

/// What a triangle carries upwards (saturation, engine/DESIGN.md, section 2.2): the attributes of
/// its successor, the record of the collapse that created it. The box is kept here because every
/// evaluation of a collapse asks for it; the rest is read from the record.
struct CarriedState {
  GridBox roi;  ///< Empty for a triangle of the full TIN.
  /// Index of its successor in Tile::records; kNone for a triangle of the full TIN.
  std::uint32_t record = kNone;
  SampleSlot samples;  ///< Removed samples inside this triangle.
  /// Length of the longest chain of collapses that ends with its successor: the rank of that record
  /// plus 1, but at most 65 535; 0 for a triangle of the full TIN.
  std::uint16_t chain = 0;
  bool holds_heights = false;  ///< Some of `samples` have a height.
  bool holds_voids = false;    ///< Some of `samples` have none.
};

/// Makes record `r`, which has index `id` in Tile::records, the successor of a triangle.
inline void carry_record(CarriedState& carried, const VertexSplit& r, std::uint32_t id) noexcept {
  carried.roi = r.roi;
  carried.record = id;
  carried.chain = static_cast<std::uint16_t>(r.rank == UINT16_MAX ? r.rank : r.rank + 1);
}

/// Per-vertex facts of a tile.
struct VertexState {
  float reach = 0.0F;        ///< As Sample::reach.
  std::uint16_t degree = 0;  ///< Neighbours in the mesh.
  bool locked = false;       ///< On a seam: may be collapsed into, is not collapsed itself.
};

/// Constants of a build that measuring needs, in height codes.
struct MeasureUnits {
  HeightEncoding heights;
  double quantum_code = 1.0;     ///< One height quantum, as a difference of codes.
  double void_slope_code = 0.0;  ///< Height codes charged per ground unit that the border moves.
  bool exact_codes = false;      ///< Codes are integers: residuals of small stars have no rounding.

  /// What a length on the ground is charged, in height codes. An infinite one is charged infinity,
  /// whatever the slope.
  [[nodiscard]] double charge(double reach) const noexcept {
    return std::isinf(reach) ? std::numeric_limits<double>::infinity()
                             : std::abs(reach) * void_slope_code;
  }
};

/// A tile: everything that a collapse reads and changes. A parent gets the TIN, `carried` with the
/// records that it names, and all samples or carried ones (construct/hierarchy/tile_push.h).
struct Tile {
  Tin tin;
  std::vector<CarriedState> carried;      ///< One for each of tin.triangles.
  std::vector<VertexState> vertex_state;  ///< One for each of tin.vertices.
  SampleLists samples;
  /// First the records that the tile begins with: foreign ones, which its children pushed up, or
  /// those of a first pass (construct/collapse/first_pass.h), which no file keeps. Then its own, in
  /// the order of the collapses.
  std::vector<VertexSplit> records;
  /// Stars of its own records. The successors of the triangles in a star are the records that need
  /// the star's record: it saturates over them, and each has a lower index.
  RecordStars stars;
  MeasureUnits units;
  /// Every grid point inside is a sample, as on rasters: then samples may be joined into blocks.
  bool samples_fill_grid = false;
  bool has_voids = false;  ///< Some triangle is void or some sample has no height.
};

/// Sets everything else of a tile that holds the full TIN: `carried`, `vertex_state`, `has_voids`,
/// the samples of its CornerWitnesses, and room for samples and records.
/// @param witnesses  By vertices. Null: no border is in reach, and all reaches are +infinity.
void start_tile(Tile& tile, const BorderWitnesses* witnesses);

/// The error at which each of tin.triangles dies, that of its successor; kLivesOn for a triangle of
/// the full TIN. REQUIRES: the errors of the records are final. Cost: linear.
[[nodiscard]] std::vector<float> deaths_of(const Tile& tile);

}  // namespace ptin
