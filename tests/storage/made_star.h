// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stars of made-up records: rings around a vertex that a page and its readers accept, of no mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "storage/star.h"

namespace ptin::test {

/// Positions of a ring around u within `box`, counter-clockwise: around u where it lies inside, from
/// one side of the border to the other where it lies on the border.
/// @param degree  At least 3; a small box may have room for fewer corners.
/// @param reach   About how far the corners are from u.
/// REQUIRES: u is no corner of `box`, and lies in it.
[[nodiscard]] std::vector<GridPoint> made_ring(GridPoint u, const GridBox& box, std::size_t degree,
                                               std::int32_t reach, std::mt19937_64& random);

/// Takes w, vl, vr and the classes of the two triangles of w from the ring, as kNoLeft and kNoRight
/// of the record say.
void name_by_ring(VertexSplit& r, std::span<const RingCorner> ring);

/// Makes the roi and the interval of heights such that they hold the ring too.
void hold_ring(VertexSplit& r, std::span<const RingCorner> ring, const HeightEncoding& heights);

/// A record with the ring of these positions around r.u, where u and all corners have r.height and
/// all triangles live on. Takes error, deviation, rank and the two border flags from `r`.
void add_star(StarredRecords& records, VertexSplit r, const std::vector<GridPoint>& ring,
              const HeightEncoding& heights);
void add_star(StarredRecords& records, VertexSplit r, const std::vector<RingCorner>& ring);

}  // namespace ptin::test
