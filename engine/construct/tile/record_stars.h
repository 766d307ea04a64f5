// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stars of a tile's records, until the errors at which their triangles die are final
// (engine/DESIGN.md, section 2.10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mesh/tin.h"
#include "storage/star.h"

namespace ptin {

/// The stars of records, in the order of the records; their rings are those of StarredRecords. A
/// triangle names its successor, the record whose error will be its death.
struct RecordStars {
  std::vector<RingCorner> corners;  ///< Ring after ring; all deaths are kLivesOn as yet.
  /// The successor of each corner's triangle, as an index of Tile::records; kNone for a triangle of
  /// the full TIN, and where there is no triangle.
  std::vector<std::uint32_t> successors;
  std::vector<std::uint32_t> ring_end;  ///< Ends of stars, in `corners`.

  /// Makes room for stars: six triangles each, and meshes have fewer in the mean.
  void reserve(std::size_t stars);
};

/// Gives triangles their deaths.
/// @param successors  One for each of `corners`.
/// @param error_of    Called with the index of a successor; gives its final error. Cost: linear.
template <class ErrorOf>
void set_deaths(std::span<RingCorner> corners, std::span<const std::uint32_t> successors,
                const ErrorOf& error_of) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (successors[i] != kNone) {
      corners[i].death = error_of(successors[i]);
    }
  }
}

/// Own records with their stars, when all errors are final.
/// @param records  The tile's: foreign ones and own ones.
/// @param first    The first own one; records without a star at the beginning of the own ones, those
///     of a first pass, get empty rings.
/// Cost: linear. The arguments are used up.
[[nodiscard]] StarredRecords starred_records(std::vector<VertexSplit>&& records, std::size_t first,
                                             RecordStars&& stars);

}  // namespace ptin
